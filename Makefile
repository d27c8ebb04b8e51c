# Everything a checkout needs, on a machine with Python 3.11 or newer and make.
#   make atlas      set up, then the dense atlas of the nominal adult into results/atlas/
#   make feedback   figures of delayed feedback and of coupled joints into results/feedback/
#   make population Monte Carlos of US adults into results/us-adults/ and results/us-adults-feedback/
#   make test       set up, then run the tests
#   make check      format, lint, types, tests
#   make docs       the documentation into docs/_build/html (about two minutes)
#   make docs-check the same without its output and figures: references, links (half a minute)
#   make bench      every benchmark, and results/benchmarks/README.md (about twenty minutes)
#   make reproduce  the 2007 paper, number by number
#   make check-all  make check on every Python from 3.11 on that is at hand
#   make man        the man page, into build/
#   make dist       wheel and archive of the source into dist/, looked over
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PYTHONS := 3.11 3.12 3.13 3.14
SPHINX := $(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet -b html
PAGE := $(wildcard src/standfast/explore/page/*.js)

.PHONY: atlas feedback population test check docs docs-check bench reproduce check-all man dist format clean
.DELETE_ON_ERROR:

atlas: $(VENV)/run.stamp
	mkdir -p results/atlas
	$(BIN)/standfast sweep studies/atlas.toml -o results/atlas/atlas.h5
	$(BIN)/standfast thresholds results/atlas/atlas.h5 -o results/atlas
	$(BIN)/standfast plot results/atlas/atlas.h5 -o results/atlas

feedback: $(VENV)/run.stamp
	mkdir -p results/feedback
	@for study in feedback delay-margin passive-support windows root-locus coupling; do \
	  $(BIN)/standfast sweep studies/$$study.toml -o results/feedback/$$study.h5 && \
	  $(BIN)/standfast plot results/feedback/$$study.h5 -o results/feedback || exit 1; done

population: $(VENV)/run.stamp
	mkdir -p results/us-adults
	rm -f results/us-adults/us-adults.h5
	$(BIN)/standfast population studies/us-adults.toml -o results/us-adults/us-adults.h5 \
	  > results/us-adults/us-adults.txt
	cat results/us-adults/us-adults.txt
	mkdir -p results/us-adults-feedback
	rm -f results/us-adults-feedback/us-adults-feedback.h5
	$(BIN)/standfast population studies/us-adults-feedback.toml \
	  -o results/us-adults-feedback/us-adults-feedback.h5 \
	  > results/us-adults-feedback/us-adults-feedback.txt
	cat results/us-adults-feedback/us-adults-feedback.txt

reproduce: $(VENV)/run.stamp
	$(BIN)/standfast reproduce

test: $(VENV)/test.stamp
	$(BIN)/python -m pytest -n auto --dist worksteal

check: $(VENV)/check.stamp
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/codespell
	$(if $(PAGE),$(BIN)/biome ci --error-on-warnings $(PAGE))
	$(MAKE) test

docs: $(VENV)/docs.stamp
	rm -rf docs/_build docs/copied docs/gallery docs/reference/generated
	$(SPHINX) -d docs/_build/doctrees docs docs/_build/html

# What pages run is run by the tests, and half of the time of a build; a cell that was not run has no language.
docs-check: $(VENV)/docs.stamp
	rm -rf docs/_build docs/copied docs/gallery docs/reference/generated
	$(SPHINX) -D nb_execution_mode=off -D suppress_warnings=myst-nb.lexer -D plot_gallery=0 \
	  -d docs/_build/unrun docs docs/_build/links

# Each Python has an environment of its own, which is kept; what is not at hand is said.
check-all:
	@for version in $(PYTHONS); do \
	  if python$$version -c '' 2>/dev/null; then \
	    $(MAKE) check PYTHON=python$$version VENV=.venv/$$version || exit 1; ran="$$ran $$version"; \
	  else missing="$$missing $$version"; fi; done; \
	echo "checked on Python:$${ran:- none}; not at hand:$${missing:- none}"

man: $(VENV)/test.stamp
	mkdir -p build
	$(BIN)/argparse-manpage --module standfast.cli.app --function build_parser \
	  --project-name standfast --manual-title standfast --output build/standfast.1 \
	  --version "$$($(BIN)/python -c 'import standfast; print(standfast.__version__)')" \
	  --description "how stiff must ankle, knee and hip be for a person to stand"

# The wheel is built out of the archive and installed apart from the checkout; the archive's tests
# are collected.
dist: man
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[test,release]'
	rm -rf dist
	$(BIN)/python -m build --outdir dist
	$(BIN)/twine check --strict dist/*
	$(BIN)/check-wheel-contents dist/*.whl
	rm -rf build/try && mkdir -p build/try
	tar -xzf dist/*.tar.gz -C build/try --strip-components=1
	cd build/try && PYTHONPATH=src ../../$(BIN)/python -m pytest --collect-only -qq >/dev/null
	$(BIN)/python -m venv build/try/.venv
	build/try/.venv/bin/python -m pip install --quiet --disable-pip-version-check -c constraints.txt dist/*.whl
	build/try/.venv/bin/standfast cite

bench: $(VENV)/bench.stamp
	@for script in verdicts storing peers feedback sway population workers growth startup tricks cost report; do \
	  $(BIN)/python benchmarks/$$script.py || exit 1; done

format: $(VENV)/check.stamp
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .
	$(if $(PAGE),$(BIN)/biome check --write $(PAGE))

$(VENV)/bench.stamp: $(VENV)/test.stamp
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[test,bench]'
	@touch $@

$(VENV)/docs.stamp: $(VENV)/run.stamp
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[docs]'
	@touch $@

clean:
	rm -rf $(VENV)

# One environment; each level of it adds packages to the one before.
$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "standfast needs Python 3.11 or newer; name one: make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 1; }
	$(PYTHON) -m venv $(VENV)

$(VENV)/run.stamp: pyproject.toml constraints.txt | $(VENV)/bin/python
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e .
	@touch $@

$(VENV)/test.stamp: $(VENV)/run.stamp
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[test]'
	@touch $@

$(VENV)/check.stamp: $(VENV)/test.stamp
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[test,check]'
	@touch $@
