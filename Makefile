# `make setup` once; every other target sets up what is missing. Needs Python 3.11 or 3.12, and nothing else.
PYTHON := $(shell for name in python3.12 python3.11 python3; do \
	$$name -c 'import sys, venv; sys.exit(not (3, 11) <= sys.version_info < (3, 13))' 2>/dev/null && echo $$name && break; done)
VENV ?= .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
WARM := $(VENV)/.warm

.PHONY: help setup demo test lint bench recovery clean

help:
	@echo "make setup   .venv with hjcamp and all it needs, kernels compiled (about 3 minutes the first time)"
	@echo "make demo    hjcamp run campaign=robustness_vertical: 56 tests, tables, report.html"
	@echo "make test    lint, types, layers, tests"
	@echo "make lint    lint, types, layers"
	@echo "make bench   speed of the model against the same model in SciPy, and of the whole chain"
	@echo "make recovery  calibrate 20 simulated rigs drawn at random; the result is docs/identification_recovery.md"
	@echo "make clean   remove .venv and caches; runs/ stays"

setup: $(WARM)

$(INSTALLED): pyproject.toml constraints.txt
	@test -n "$(PYTHON)" || { echo "Python 3.11 or 3.12 with its venv module is needed; none was found" >&2; exit 1; }
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[test]'
	@touch $@

$(WARM): $(INSTALLED)
	$(BIN)/hjcamp doctor --warm
	@touch $@

demo: $(WARM)
	$(BIN)/hjcamp run campaign=robustness_vertical

lint: $(INSTALLED)
	$(BIN)/ruff check hjcamp tests benchmarks
	$(BIN)/mypy
	$(BIN)/lint-imports

test: $(INSTALLED) lint
	$(BIN)/python -m pytest

bench: $(WARM)
	$(BIN)/python benchmarks/bench.py

recovery: $(WARM)
	$(BIN)/python tests/calibrate/recovery_study.py > docs/identification_recovery.md.part
	mv docs/identification_recovery.md.part docs/identification_recovery.md

clean:
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache .import_linter_cache build dist
