# Everything here does its own set-up: `make demo` and `make test` work on a fresh clone.
# Needs GNU make and Python >= 3.11; choose one with `make PYTHON=python3.12 test`.

PYTHON ?= python3
UV_VERSION := 0.13.8

# Only pinned, hashed packages are installed, and pyright uses the copy in its own wheel.
export PYRIGHT_PYTHON_IGNORE_WARNINGS := 1
export NO_MKDOCS_2_WARNING := 1
# Where somebody asks for no bytecode every process of the tests would compile the house anew.
export PYTHONDONTWRITEBYTECODE :=

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help venv demo paper test types style suite page motions test-lowest coverage bench docs release lock clean

help:
	@echo "make demo         show in a minute what springs can be told to do, on one page in out/demo"
	@echo "make paper        recompute the paper's claims, walk a robot, run the three walls; into out/"
	@echo "make test         lint, type-check, check the room contract, build the docs, run all tests"
	@echo "make test-lowest  run the tests on the oldest supported dependencies"
	@echo "make coverage     run all tests and tell which lines they never reach"
	@echo "make bench        print speed ratios against named peers"
	@echo "make page         build the studio's page from studio/ (needs Node 20.19 or newer)"
	@echo "make motions      compute the small motions of the studio's gallery again"
	@echo "make docs         build the documentation into site/"
	@echo "make release      rehearse a release: build it, install it on every Python here; uploads nothing"
	@echo "make venv         only set up .venv/"
	@echo "make lock         pin the dependencies again (UPGRADE=--upgrade takes newer ones)"
	@echo "make clean        remove everything that is made here"

venv: .venv/.ready

demo: .venv/.ready
	.venv/bin/stepwell demo --out out/demo

paper: .venv/.ready
	.venv/bin/stepwell paper --out out/paper
	.venv/bin/stepwell walk robot-forward --cycles 4 --out out/walk
	.venv/bin/stepwell maze robot-antennas three-walls --out out/maze

# Two at a time: types keep one core busy, so that tests begin on the other. They build the docs.
test: .venv/.ready
	@$(MAKE) --no-print-directory --jobs=2 types style suite

suite: .venv/.ready
	@# What the tests run most is compiled once, before two processes ask for it.
	@for preset in paper-forward three-wave; do \
	  STEPWELL_KERNELS=compiled .venv/bin/stepwell run preset:$$preset >/dev/null 2>&1; \
	done
	.venv/bin/pytest

types: .venv/.ready
	.venv/bin/pyright

style: .venv/.ready
	.venv/bin/ruff check
	.venv/bin/ruff format --check
	.venv/bin/lint-imports

# By itself, for it makes all of Python half as fast again.
coverage: .venv/.ready
	.venv/bin/pytest --cov --cov-report=term

test-lowest: .venv-lowest/.ready
	.venv-lowest/bin/pytest -m "not shown"

bench: .venv/.ready
	.venv/bin/python benchmarks/run.py

docs: .venv/.ready
	.venv/bin/mkdocs build --strict

# $(1) is the virtual environment, $(2) its lock file. No build isolation: what builds the
# package is pinned too. Python compiles what is imported when it is, which is a part of it, in half
# the time. Running this again on an existing environment only brings it up to date.
define make_venv
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "Stepwell needs Python >= 3.11, and '$(PYTHON)' is not one. Name one that is:" \
	    "make PYTHON=python3.12 $(MAKECMDGOALS)" >&2; exit 1; }
	@$(PYTHON) -m venv $(1) || { \
	  echo "'$(PYTHON)' cannot make a virtual environment. On Debian and Ubuntu install" \
	    "python3-venv, or name another Python: make PYTHON=python3.12 $(MAKECMDGOALS)" >&2; exit 1; }
	$(1)/bin/python -m pip install --quiet --disable-pip-version-check --no-compile --require-hashes --no-deps -r $(2)
	$(1)/bin/python -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps -e .
	@touch $@
endef

.venv/.ready: requirements.lock pyproject.toml
	$(call make_venv,.venv,requirements.lock)

.venv-lowest/.ready: requirements-lowest.lock pyproject.toml
	$(call make_venv,.venv-lowest,requirements-lowest.lock)

# One file for every platform and every Python from 3.11 on, with hashes and without an index.
# What is built is committed, so that nobody who installs it needs Node; a test builds it anew.
page:
	cd studio && npm ci --no-audit --no-fund --ignore-scripts && npm run check && npm run build

# The small motions of the gallery: again after a preset was changed or added.
motions: .venv/.ready
	.venv/bin/python -m stepwell.studio.gallery

lock:
	$(PYTHON) -m venv .venv-lock
	.venv-lock/bin/python -m pip install --quiet --disable-pip-version-check uv==$(UV_VERSION)
	@# Drake reads SDF files without Mosek, a solver under a commercial licence, which it names.
	@# MuJoCo Warp goes with one release of MuJoCo, the newest: its tests are left out on the oldest.
	$(call compile,highest,requirements.lock,--extra gpu)
	$(call compile,lowest-direct,requirements-lowest.lock)

compile = .venv-lock/bin/uv --no-config pip compile pyproject.toml --extra dev $(3) --quiet $(UPGRADE) \
  --universal --python-version 3.11 --generate-hashes --no-emit-index-url --no-emit-package stepwell \
  --no-emit-package mosek \
  --no-annotate --custom-compile-command "make lock" --resolution $(1) --output-file $(2)

clean:
	rm -rf .venv .venv-lowest .venv-lock .coverage .hypothesis .import_linter_cache .pytest_cache \
	  .ruff_cache build dist out site
	find src tests examples benchmarks -name __pycache__ -type d -prune -exec rm -rf {} + 2>/dev/null || true

# Nothing leaves this machine: docs/releasing.md says what a person does then.
release: .venv/.ready
	PYTHONPATH=tests .venv/bin/python tests/release/rehearse.py dist
