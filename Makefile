# `make setup` once; every other target sets up what is missing. Needs Python 3.11, 3.12 or 3.13, and nothing else.
PYTHON := $(shell for name in python3.13 python3.12 python3.11 python3; do \
	$$name -c 'import sys, venv, ensurepip; sys.exit(not (3, 11) <= sys.version_info < (3, 14))' 2>/dev/null && echo $$name && break; done)
VENV ?= .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/.installed
WARM := $(VENV)/.warm
# of make thesis_gap
EFFORT ?= standard
TESTABLE := $(VENV)/.testable
DOCUMENTED := $(VENV)/.documented

# Python compiles a file when it is first imported, not all that are never used; what it compiled is there for the next process
unexport PYTHONDONTWRITEBYTECODE
PIP = $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile --constraint constraints.txt

.PHONY: help say-setup say-demo say-test setup demo test studies lint catalogue docs bench benchmark levels hidden_tables any_plant foreign_machines public unmoved unmoved-long next_value thesis_gap tour_data gallery pump_cost convergence fidelity validation faults kills damage recovery bad_calls wrong_logs disturbed dist clean

help:
	@echo "make setup   .venv with hjcamp and all it needs, every kernel compiled; README says how long it takes; the demo needs less"
	@echo "make demo    hjcamp run campaign=robustness_vertical: 56 tests, tables, report.html"
	@echo "make test    lint, types, layers, tests"
	@echo "make studies the tests that take longest; make test leaves them out"
	@echo "make lint    lint, types, layers"
	@echo "make catalogue  a page for each effect and each plant, in site/catalogue"
	@echo "make docs    README, docs/ and the catalogue as a site, in site/html; links are checked"
	@echo "make bench   speed of the model against the same model in SciPy, and of the whole chain"
	@echo "make benchmark  226 hidden effects on the truth plant (an hour and a half; goes on where it stopped); docs/benchmark.md"
	@echo "make levels  200 rigs with nothing missing and 348 with an effect, other contacts and laws: the verdict's levels (2 hours); docs/levels.md"
	@echo "make hidden_tables  effects that hide behind means and deviations (21 cases, a minute each); docs/hidden_tables.md"
	@echo "make any_plant  hidden effects on an axis, tanks, a servo and two joints, imported and diagnosed; docs/any_plant.md"
	@echo "make foreign_machines  hidden effects on eight machines that others might bring; docs/foreign_machines.md"
	@echo "make public DATA=FOLDER  published benchmark sets that you have put there: our number next to the published one (docs/public.md)"
	@echo "make unmoved BASE=COMMIT  whether this code answers twelve sets of logs bit for bit as that commit does (10 minutes); unmoved-long: sixty"
	@echo "make next_value  how many tests 'hjcamp next' saves against random choice; docs/next_value.md"
	@echo "make thesis_gap  what the printed tables of 5.4 say is missing; docs/thesis_gap.md, model=refit"
	@echo "make tour_data  the sample logs of the tour and its page"
	@echo "make gallery   one worked case of each answer (some minutes); docs/gallery.md and README's sample"
	@echo "make recovery  calibrate 20 simulated rigs drawn at random; the result is docs/identification_recovery.md"
	@echo "make convergence  the published campaigns at smaller tolerances of a step; the result is docs/convergence.md"
	@echo "make pump_cost  every campaign of chapters 4 and 5 with the weaker pump; docs/pump_cost.md"
	@echo "make fidelity  every published cell beside the simulated mean; the result is docs/fidelity.md"
	@echo "make validation  errors against an independent solution; the result is docs/validation.md"
	@echo "make faults    every fault of the rig at the start, middle and end of a test; docs/rig_faults.md"
	@echo "make kills     200 kills at random moments, then resume;   make damage  10 000 damaged log files"
	@echo "make wrong_logs  seventy logs that are wrong on purpose, and what is said of them; docs/wrong_logs.md"
	@echo "make disturbed  every long command killed (200 times), interrupted twice, short of memory, files and disk; docs/disturbances.md"
	@echo "make bad_calls  a thousand bad calls over every option and file; docs/bad_calls.md"
	@echo "make dist    wheel and sdist in dist/, opened and checked as a stranger would (docs/release.md); five minutes"
	@echo "make clean   remove .venv and caches; runs/ stays"

# what a target does and how long it takes, before it begins
say-setup:
	@echo "make setup: hjcamp and its packages into $(VENV) (about 700 MB), then every kernel compiled; a minute or two on two cores"
say-demo:
	@echo "make demo: hjcamp and its packages into $(VENV) where they are not, then 56 simulated tests, their tables and a page; a minute on two cores"
say-test:
	@echo "make test: what tests need into $(VENV) where it is not, then ruff, mypy, layers and every test but the long ones; ten minutes, or fifteen where no kernel is compiled yet, on two cores"

setup: say-setup $(WARM)

$(INSTALLED): pyproject.toml constraints.txt
	@test -n "$(PYTHON)" || { echo "Python 3.11, 3.12 or 3.13 with its venv module is needed; found: $$(python3 --version 2>&1 || echo none)" >&2; exit 1; }
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(PIP) --upgrade pip  # those that come with Python read the index half as fast
	$(PIP) --editable .
	@touch $@

# what only the tests need; the demo does not wait for it
$(TESTABLE): $(INSTALLED)
	$(PIP) --editable '.[test]'
	@touch $@

$(WARM): $(INSTALLED)
	$(BIN)/hjcamp doctor --warm
	@touch $@

# it compiles the two kernels that it uses; what the tour needs is compiled while its answer is read
demo: say-demo $(INSTALLED)
	$(BIN)/hjcamp run campaign=robustness_vertical
	@test -n "$$CI" || $(BIN)/hjcamp doctor --warm --detach

lint: $(TESTABLE)
	$(BIN)/ruff check hjcamp tests benchmarks
	$(BIN)/ruff format --check hjcamp tests benchmarks
	$(BIN)/mypy
	$(BIN)/lint-imports

# as many processes as tests/conftest.py says, four at most, in its order; a file's tests stay together: they share kernels and logs
test: say-test $(TESTABLE) lint
	$(BIN)/python -m pytest --numprocesses auto --maxprocesses 4 --dist loadfile --no-loadscope-reorder

# the tests that take longest, or repeat others with other data
studies: $(TESTABLE)
	$(BIN)/python -m pytest --numprocesses auto --maxprocesses 4 --dist loadfile --durations 10 -m study

catalogue: $(INSTALLED)
	$(BIN)/hjcamp effects --pages site/catalogue

$(DOCUMENTED): $(INSTALLED)
	$(PIP) --editable '.[docs]'
	@touch $@

# README, docs/ and the catalogue as one site; fails where a link leads nowhere
docs: $(DOCUMENTED) catalogue
	$(BIN)/python docs/site/make_site.py site/catalogue

bench: $(WARM)
	$(BIN)/python benchmarks/speed/bench.py
	$(BIN)/python benchmarks/speed/loop_timing.py
	$(BIN)/python benchmarks/speed/live_timing.py
	$(BIN)/python benchmarks/speed/plant_timing.py

benchmark: $(WARM)
	$(BIN)/python -m benchmarks.hidden_effects --size full --effort standard --workers 2 --shift 700000 --page docs/benchmark.md

hidden_tables: $(WARM)
	$(BIN)/python -m benchmarks.hidden_tables --page docs/hidden_tables.md

levels: $(WARM)
	$(BIN)/python -m benchmarks.levels --workers 2
	$(BIN)/python -m benchmarks.levels --workers 2 --effects
	$(BIN)/python -m benchmarks.levels --workers 2 --seeds 921000 60 --into benchmarks/results/levels_fresh.csv --page docs/levels.md

any_plant: $(WARM)
	$(BIN)/python -m benchmarks.any_plant --page docs/any_plant.md

# DATA: a folder with the files of published sets as they were downloaded
public: $(WARM)
	$(BIN)/python -m benchmarks.public $(DATA)

foreign_machines: $(WARM)
	$(BIN)/python -m benchmarks.foreign_machines --seeds 1001 1002 1003 --page docs/foreign_machines.md

# BASE=COMMIT: that commit and this code (or NOW=COMMIT) diagnose the same logs on this machine, and no bit may differ
unmoved: $(WARM)
	$(BIN)/python -m benchmarks.unmoved $(if $(BASE),--base $(BASE)) $(if $(NOW),--now $(NOW))

unmoved-long: $(WARM)
	$(BIN)/python -m benchmarks.unmoved --long --base $(or $(BASE),HEAD~1)

next_value: $(WARM)
	$(BIN)/python -m benchmarks.next_value --page docs/next_value.md

thesis_gap: $(WARM)
	$(BIN)/hjcamp diagnose --tables 5.4.1 5.4.2 --effort $(EFFORT) --workers 2 --json docs/thesis_gap.json
	cp runs/tables_5.4.1_5.4.2_$(EFFORT)_1/cells.png docs/images/thesis_gap.png
	sed 's|(cells.png)|(images/thesis_gap.png)|' runs/tables_5.4.1_5.4.2_$(EFFORT)_1/page.md > docs/thesis_gap.md
	rm -f conf/model/refit.yaml
	$(BIN)/hjcamp add docs/thesis_gap.json --as refit
	cp docs/thesis_gap.json hjcamp/plants/pump_joint/published/refit.json

tour_data: $(WARM)
	$(BIN)/python tests/cli/make_tour_data.py
	$(BIN)/python tests/cli/write_tour_page.py

gallery: $(INSTALLED)
	$(BIN)/python docs/gallery/make_logs.py
	$(BIN)/python docs/gallery/build_gallery.py

convergence: $(INSTALLED)
	$(BIN)/python benchmarks/published/convergence.py

fidelity: $(WARM)
	$(BIN)/python benchmarks/published/fidelity.py

pump_cost: $(WARM)
	$(BIN)/python benchmarks/published/pump_cost.py

validation: $(WARM)
	$(BIN)/python benchmarks/published/validation.py

faults: $(WARM) $(TESTABLE)
	$(BIN)/python tests/rig/write_fault_table.py

kills: $(WARM)
	$(BIN)/python tests/rig/kill_campaign.py 300

damage: $(WARM)
	$(BIN)/python tests/records/damage_many_logs.py 10000

disturbed: $(WARM)
	$(BIN)/python tests/cli/disturbed_commands.py 2 --kills 200

wrong_logs: $(INSTALLED)
	$(BIN)/python tests/records/write_wrong_logs.py

bad_calls: $(WARM)
	$(BIN)/python tests/cli/bad_calls.py 600 --page docs/bad_calls.md

recovery: $(WARM)
	$(BIN)/python tests/calibrate/recovery_study.py > docs/identification_recovery.md.part
	mv docs/identification_recovery.md.part docs/identification_recovery.md

# TAG=v0.1.0 also checks that the tag is the version
dist: $(TESTABLE)
	$(PIP) --editable '.[dist]'
	$(BIN)/python .ci/check_dist.py $(TAG)

clean:
	rm -rf $(VENV) .pytest_cache .mypy_cache .ruff_cache .import_linter_cache build dist
