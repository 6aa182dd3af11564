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

.PHONY: audit bench check chromium clean compile demo house licences lint lock look lowest mutate release-check same sbom test trial unit

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

# peers in an environment of their own; what is measured of this tree alone, in its own
OWN_BENCH := coordinates train_map measured paths
bench: $(BENCH_STAMP)  ## peers side by side; NAME=shafts geared train_map measured paths coordinates for another; ARGS="--quick" a short one
	PYTHONPATH=src $(if $(filter $(NAME),$(OWN_BENCH)),$(BIN),$(BENCH_BIN))/python -W ignore bench/$(or $(NAME),run).py $(ARGS)

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

lowest: $(STAMP)  ## demo and quick tests with the lowest and the newest allowed libraries, half an hour; checks/records/bounds.md
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

trial: $(STAMP)  ## long evidence, NAME=pairs; without it the list; ARGS="..." is passed on; most write a page trials/records/NAME.md
	@OPENBLAS_NUM_THREADS=1 $(BIN)/python trials $(NAME) $(ARGS)

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
