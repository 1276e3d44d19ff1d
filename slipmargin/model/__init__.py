"""The machine as mathematics: frozen parts that limits, paths and the simulator share."""

from slipmargin.model.model import Model as Model, nominal_model as nominal_model
