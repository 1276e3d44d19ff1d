"""Installs the package for ament_python."""

from setuptools import setup

NAME = "slipmargin_limiter"

setup(
    name=NAME,
    version="0.1.0",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
    ],
    install_requires=["setuptools", "slipmargin"],
    entry_points={"console_scripts": [f"limiter = {NAME}.node:main"]},
)
