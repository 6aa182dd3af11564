# Set-up: everything lands in .venv at the root of this checkout.
PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.installed

# Python keeps the bytecode of what it loads, also where the environment forbids it: the tests start
# some hundred processes, and each took seconds to compile the libraries anew.
export PYTHONDONTWRITEBYTECODE :=

DOCS_STAMP := .venv/.docs-installed

BENCH_BIN := .bench-venv/bin
BENCH_STAMP := .bench-venv/.installed
AUDIT_BIN := .audit-venv/bin
AUDIT_STAMP := .audit-venv/.installed

.PHONY: audit bench bench-coordinates bench-geared bench-measure bench-paths bench-shafts bench-train-map check chromium clean compile demo friction-evidence house licences lint lock look lowest mutate release-check same sbom test trial-answers trial-app trial-attacks trial-base-sets trial-branches trial-coverage trial-damage trial-defects trial-experiment trial-heat trial-hostile trial-kills trial-labels trial-located trial-long trial-multipliers trial-pairs trial-public trial-series trial-shafts trial-stamps trial-swings trial-trains trial-turn trial-turning trial-verdicts unit

demo: $(STAMP)  ## the main job: the rig's case file to a report
	$(BIN)/thermogear example rig > .venv/rig.toml
	$(BIN)/thermogear run .venv/rig.toml -o .demo

PYTEST := $(BIN)/python -m pytest -q -n auto --dist loadfile --no-loadscope-reorder

test: $(STAMP) lint  ## every check, slow layer included; tests of the page open a browser where one is installed
	$(PYTEST)

chromium:  ## the browser that tests pages, Debian's package; without it those tests are left out
	@command -v chromium || command -v chromium-browser || command -v google-chrome || { \
	  as=$$(test "$$(id -u)" = 0 || echo "sudo -n"); \
	  $$as apt-get -qq update && DEBIAN_FRONTEND=noninteractive \
	  $$as apt-get -qq install --no-install-recommends chromium > /dev/null; } || \
	  echo "no browser could be installed; tests of moving pages will be left out"

check: $(STAMP) lint unit  ## the fast checks

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

unit: $(STAMP)
	$(PYTEST) -m "not slow"

$(STAMP): pyproject.toml requirements/boot.txt requirements/dev.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "thermogear needs Python 3.11 or newer; got $$($(PYTHON) --version); set PYTHON=python3.11"; exit 2; }
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/boot.txt
	VIRTUAL_ENV=$(CURDIR)/.venv $(BIN)/uv pip install --quiet --require-hashes -r requirements/dev.txt
	VIRTUAL_ENV=$(CURDIR)/.venv $(BIN)/uv pip install --quiet --no-deps --no-build-isolation -e .
	@touch $@

.PHONY: docs validation
docs: $(DOCS_STAMP)  ## the documentation site; a warning or a dead link is an error
	rm -rf docs/_build/html
	$(BIN)/python -m sphinx -E -b html -j auto -n -W --keep-going -q docs docs/_build/html
	$(BIN)/python docs/_site/check_html.py docs/_build/html

validation: $(STAMP)  ## measure the numbers of the site's validation and thesis pages anew
	$(BIN)/python -m pytest -q -n auto --dist loadfile --no-loadscope-reorder --validation=docs/validation.json tests
	$(BIN)/python docs/_site/collect.py docs/thesis.json

$(DOCS_STAMP): $(STAMP) requirements/docs.txt
	VIRTUAL_ENV=$(CURDIR)/.venv $(BIN)/uv pip install --quiet --require-hashes -r requirements/docs.txt
	@touch $@

bench-shafts: $(BENCH_STAMP)  ## matrices of geared shafts beside ROSS's
	PYTHONPATH=src $(BENCH_BIN)/python -W ignore bench/shafts.py 2> .bench-venv/shafts.log

bench-geared: $(BENCH_STAMP)  ## drive trains that lose contact, our engine beside others; GEARED="--closure" for the public sections
	PYTHONPATH=src $(BENCH_BIN)/python -W ignore bench/geared.py $(GEARED) 2> .bench-venv/geared.log

bench-coordinates: $(STAMP)  ## what more coordinates change in a drive train's impacts, and cost
	$(BIN)/python bench/coordinates.py

bench-train-map: $(STAMP)  ## a drive train's map on one thread and on two; TRAIN_MAP="--grid 6x4" a short one, --write the page
	$(BIN)/python bench/train_map.py $(TRAIN_MAP)

bench: $(BENCH_STAMP)  ## peers side by side, own environment; BENCH=--quick for a short one
	PYTHONPATH=src $(BENCH_BIN)/python bench/run.py $(BENCH)

bench-measure: $(STAMP)  ## what measure costs by length, stage and folder; MEASURE=--write for the page
	$(BIN)/python bench/measured.py $(MEASURE)

bench-paths: $(STAMP)  ## what one answer costs, before and after; PATHS=--write for the page
	$(BIN)/python bench/paths.py $(PATHS)

$(BENCH_STAMP): $(STAMP) requirements/bench.txt requirements/bench-fortran.txt
	test -x $(BENCH_BIN)/python || $(BIN)/python -m venv .bench-venv
	VIRTUAL_ENV=$(CURDIR)/.bench-venv $(BIN)/uv pip install --quiet --require-hashes -r requirements/bench.txt
	@VIRTUAL_ENV=$(CURDIR)/.bench-venv $(BIN)/uv pip install --quiet --no-deps --require-hashes \
	  -r requirements/bench-fortran.txt 2> .bench-venv/fortran.log || \
	  echo "numbalsoda could not be installed (.bench-venv/fortran.log); the table says so"
	@touch $@

compile: $(STAMP)  ## machine code of the kernels ahead of their first use
	$(BIN)/python checks/compile_kernels.py

licences: $(STAMP)  ## licence of every locked package; fails on GPL, AGPL or unknown
	$(BIN)/python checks/supply.py licences

sbom: $(AUDIT_STAMP)  ## CycloneDX bill of materials: dist/sbom.json
	$(BIN)/python checks/supply.py sbom

lowest: $(STAMP)  ## demo and quick tests with the lowest and the newest allowed libraries, half an hour; docs/bounds.md
	$(BIN)/python checks/bounds.py

audit: $(AUDIT_STAMP)  ## known vulnerabilities of the lock; needs the network
	@$(BIN)/python checks/supply.py audit

mutate: $(AUDIT_STAMP)  ## does a changed formula fail a test? MUTATE="--per-module 8 --seed 2" for another sample
	@$(AUDIT_BIN)/python checks/mutate.py $(MUTATE)

release-check: $(STAMP)  ## sdist and wheel built, installed without the checkout, the demo run there; needs the packages
	@set -e; place=$$(mktemp -d); trap 'rm -rf "$$place"' EXIT; \
	$(BIN)/uv build --quiet --out-dir "$$place/dist" .; \
	$(BIN)/uv venv --quiet --python $(BIN)/python "$$place/venv"; \
	VIRTUAL_ENV="$$place/venv" $(BIN)/uv pip install --quiet --constraint requirements/dev.txt \
	  "$$place"/dist/*.whl; \
	cd "$$place"; unset PYTHONPATH; \
	venv/bin/thermogear example rig -o rig.toml; \
	venv/bin/thermogear run rig.toml -o demo > demo.txt; \
	test -s demo/report.html; \
	venv/bin/python -c "import thermogear; assert 'venv' in thermogear.__file__, thermogear.__file__"; \
	venv/bin/thermogear --version; ls dist

$(AUDIT_STAMP): $(STAMP) requirements/audit.txt
	test -x $(AUDIT_BIN)/python || $(BIN)/python -m venv .audit-venv
	VIRTUAL_ENV=$(CURDIR)/.audit-venv $(BIN)/uv pip install --quiet --require-hashes -r requirements/audit.txt
	@touch $@

same: $(STAMP)  ## do all commands still store the same numbers? SAME="HEAD~1 --only run" for another commit, some cases
	@$(BIN)/python checks/same.py $(SAME)

trial-damage: $(STAMP)  ## 300 single damages to finished files and stores, minutes; docs/trial_damage.md
	@$(BIN)/python checks/trial_damage.py

trial-long: $(STAMP)  ## the shortened tests with ten times the count, minutes; docs/trial_long.md
	$(BIN)/python -m pytest -q --long=docs/trial_long.md tests

trial-pairs: $(STAMP)  ## 2 000 random pairs through the whole chain, about an hour; docs/trial_pairs.md
	@$(BIN)/python checks/trial_pairs.py

trial-public: $(STAMP)  ## what measure says of public records; PUBLIC=FOLDER; docs/public_records.md
	@$(BIN)/python checks/trial_public.py $(PUBLIC)

trial-hostile: $(STAMP)  ## 5 000 mutated cases, 95 400 mutated records of 18 kinds; docs/trial_hostile.md
	@$(BIN)/python checks/trial_hostile.py

trial-kills: $(STAMP)  ## 200 kills of eight commands, folders compared, half an hour; docs/trial_kills.md
	$(BIN)/python -W ignore checks/trial_kills.py

trial-heat: $(STAMP)  ## every steady state of the heat balance, from cold, hot and warm-ups, half an hour; docs/trial_heat.md
	@$(BIN)/python checks/trial_heat.py

trial-multipliers: $(STAMP)  ## printed digits of 40 trains on rolling bearings against another integration, ten minutes; docs/trial_multipliers.md
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python -W ignore checks/trial_multipliers.py

trial-labels: $(STAMP)  ## 2 000 random motions: every label put to another test, ten minutes; docs/trial_labels.md
	@$(BIN)/python checks/trial_labels.py

trial-located: $(STAMP)  ## located bifurcations of random drive trains against a fine sweep, cost of a proof; docs/trial_located.md
	@$(BIN)/python checks/trial_located.py

trial-trains: $(STAMP)  ## 200 random drive trains: every label asked four ways, 40 by another integration, some hours; TRAINS="--count 20" for a short one; docs/trial_trains.md
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python -W ignore checks/trial_trains.py $(TRAINS)

trial-attacks: $(STAMP)  ## what a stranger may try with the app, each attempt at a real server, a minute; docs/trial_attacks.md
	@$(BIN)/python checks/trial_attacks.py

trial-answers: $(STAMP)  ## 300 random cases through the answers, 60 through a run: no sentence against its data; docs/trial_answers.md
	@$(BIN)/python checks/trial_answers.py

trial-app: $(STAMP)  ## the app walked through in a browser: actions, times, the pictures of its page (docs/trial_app.md)
	$(BIN)/python checks/app_walk.py

trial-defects: $(STAMP)  ## records with one defect each: error before and now, or withheld, a minute; docs/trial_defects.md
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python checks/trial_defects.py

trial-coverage: $(STAMP)  ## do stated 95 % intervals of lines hold? 500 records a scenario, half an hour; docs/trial_coverage.md
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python checks/trial_coverage.py $(COVERAGE)

trial-turn: $(STAMP)  ## 40 random pairs with pitch errors: motion over a turn against an own integration, five minutes; docs/trial_turn.md
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python checks/trial_turn.py

trial-series: $(STAMP)  ## do the bands of a series hold fresh pairs of the class? ten pairs, minutes; docs/trial_series.md
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python checks/trial_series.py

trial-relief-series: $(STAMP)  ## the relief of a class by parts that it has not seen, five minutes; docs/trial_relief_series.md
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python checks/trial_relief_series.py

trial-turning: $(STAMP)  ## orders of runs of eight kinds (lost pulses, no tacho, a stop, ...): do intervals hold? ten minutes; docs/trial_turning.md
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python checks/trial_turning.py

trial-stamps: $(STAMP)  ## rates of rounded and jittering time stamps: do their intervals hold? a minute; docs/trial_stamps.md
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python checks/trial_stamps.py $(STAMPS)

trial-swings: $(STAMP)  ## records whose speed, phase or load oscillates: do intervals hold? ten minutes; SWINGS=20 for a few; docs/trial_swings.md
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python checks/trial_swings.py $(SWINGS)

trial-shafts: $(STAMP)  ## few turns of a shaft, an unknown shaft: do intervals hold? five minutes; SHAFTS=20 for a few; docs/trial_shafts.md
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python checks/trial_shafts.py $(SHAFTS)

trial-branches: $(STAMP)  ## random branches and run-ups against finer ones, ten minutes; docs/trial_branches.md
	@$(BIN)/python checks/trial_branches.py

trial-base-sets: $(STAMP)  ## base sets drawn at random that meet the thesis's table 4.2, half an hour; src/thermogear/thesis/base_sets.csv
	@$(BIN)/python checks/trial_base_sets.py

trial-verdicts: $(STAMP)  ## five verdicts on the thesis by scipy and by exact pieces, half a minute; docs/trial_verdicts.md
	@$(BIN)/python checks/verdicts.py

trial-experiment: $(STAMP)  ## the thesis's experiment on 256 sampled drive trains, ten minutes; src/thermogear/thesis/experiment.csv
	@$(BIN)/python checks/trial_experiment.py

friction-evidence: $(STAMP)  ## every friction law against measurements; docs/friction_evidence.md
	@$(BIN)/python checks/friction_evidence.py

house: $(STAMP)  ## docs/house.md anew: sizes, imports between floors, public names
	$(BIN)/python checks/house.py > docs/house.md

look: $(STAMP)  ## pages as a reader sees them, checked and as PNG in .look (package chromium)
	@$(BIN)/python tests/views/look.py > /dev/null || $(BIN)/python tests/views/look.py
	test -e .demo/report.html || $(MAKE) demo
	test -e .look/pages/thesis/report.html || $(BIN)/thermogear thesis -o .look/pages/thesis
	$(BIN)/python tests/views/look.py .look .demo/report.html .look/pages/thesis/report.html \
	  docs/_build/html

lock: $(STAMP)  ## refresh the hashed locks (no addresses are written)
	echo "uv" | $(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
	  --no-header --no-emit-index-url --no-emit-find-links - -o requirements/boot.txt
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
	  --no-header --no-emit-index-url --no-emit-find-links --all-extras pyproject.toml -o requirements/dev.txt
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
	  --no-header --no-emit-index-url --no-emit-find-links bench/requirements.in -o requirements/bench.txt
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-deps \
	  --no-header --no-emit-index-url --no-emit-find-links bench/fortran.in -o requirements/bench-fortran.txt
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes -c requirements/dev.txt \
	  --no-header --no-emit-index-url --no-emit-find-links docs/requirements.in -o requirements/docs.txt
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
	  --no-header --no-emit-index-url --no-emit-find-links requirements/audit.in -o requirements/audit.txt

clean:
	rm -rf .venv .bench-venv .audit-venv .mutate .same .demo .look
