# make fig8   the paper's Fig. 8 from nothing but Python: environment, installation, tables and pictures
# make test   everything that must hold
# make test-seeds  the tests with drawn examples under twenty random seeds (SEEDS=1-20)
# make test-surroundings  cheap tests with warnings as errors, -O, one core, another locale
# make kill  signal 9 at random moments over the long commands (KILLS=100)
# make fuzz  mutated input, shared among the commands (CASES=20000; goes on where it was stopped)
# make docs   the documentation site, in site/
# make bench  the figures of speed that the README and the site quote, and the paper's
# Versions are pinned in requirements.lock.  PYTHON=python3.12 make … uses another interpreter.

PYTHON ?= python3
OUT ?= out
SEEDS ?= 1-20
CASES ?= 20000
KILLS ?= 100
BIN := .venv/bin
PIP := PIP_CONSTRAINT="$(CURDIR)/requirements.lock" PIP_DISABLE_PIP_VERSION_CHECK=1 $(BIN)/python -m pip install --quiet

.PHONY: install fig8 test test-seeds test-surroundings kill fuzz lint types docs bench clean

install: .venv/installed


fig8: .venv/installed
	mkdir -p $(OUT)
	$(BIN)/slipmargin sweep ohio-kiwi --surface paper --out $(OUT)/fig8-paper.csv --plot $(OUT)/fig8-paper.png
	$(BIN)/slipmargin sweep ohio-kiwi --surface carpet --out $(OUT)/fig8-carpet.csv --plot $(OUT)/fig8-carpet.png

test: .venv/installed-test lint types
	$(BIN)/python -m pytest -n 2

test-seeds: .venv/installed-test
	$(BIN)/python tests/house/seeds.py --seeds $(SEEDS) --log $(OUT)/seeds -n 2

test-surroundings: .venv/installed-test
	$(BIN)/python tests/house/surroundings.py

kill: .venv/installed-test
	$(BIN)/python tests/house/killed.py --count $(KILLS)

fuzz: .venv/installed-test
	cd tests && PYTHONPATH=. OMP_NUM_THREADS=1 ../$(BIN)/python -m fuzz --count $(CASES)

lint: .venv/installed-test
	$(BIN)/ruff check .

types: .venv/installed-test
	$(BIN)/mypy

docs: .venv/installed-test $(patsubst notebooks/%.py,docs/notebooks/%.ipynb,$(wildcard notebooks/*.py))
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet

docs/notebooks/%.ipynb: notebooks/%.py .venv/installed-test
	mkdir -p docs/notebooks
	$(BIN)/jupytext --quiet --run-path notebooks --to ipynb --execute --output $@ $<

# What needs neither somebody's logs nor a night; the first lines of the other scripts say how they are run.
FILES := environment statics solvers design explore creep_bound limiter monitor_stream
TABLES := simulation paths paper

bench: .venv/installed-bench
	for name in $(FILES); do $(BIN)/python benchmarks/$$name.py benchmarks/results/$$name.json || exit 1; done
	for name in $(TABLES); do $(BIN)/python benchmarks/$$name.py --json benchmarks/results/$$name.json || exit 1; done
	$(BIN)/python benchmarks/page.py --write

.venv/installed: pyproject.toml requirements.lock
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(PIP) --editable .
	touch $@

.venv/installed-test: .venv/installed
	$(PIP) --editable '.[test,ros,urdf,frc,lerobot,docs]'
	touch $@

.venv/installed-bench: .venv/installed-test
	$(PIP) highspy pycapacity
	touch $@

clean:
	rm -rf .venv build dist site docs/notebooks $(OUT) *.egg-info
