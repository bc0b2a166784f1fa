# `make reproduce` and `make test` are all a newcomer needs: each makes .venv, with everything in it, first.
OUT ?= out
QUALITY ?= exact
SEED ?= 1
BIN = .venv/bin

.PHONY: help reproduce test lint benchmark clean

help:
	@echo "make reproduce   the gloss paper's study, from reflectance to a fitted gloss space (OUT=$(OUT) QUALITY=$(QUALITY) SEED=$(SEED))"
	@echo "make test        the test suite"
	@echo "make lint        formatting, types, direction of imports"
	@echo "make benchmark   run time against error, beside the peers"
	@echo "make clean       remove .venv and caches; studies stay"

reproduce:
	@tools/set_up.sh reproduce
	$(BIN)/gloss reproduce --out $(OUT) --quality $(QUALITY) --seed $(SEED)

test:
	@tools/set_up.sh test
	$(BIN)/python -m pytest

lint:
	@tools/set_up.sh test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

benchmark:
	@tools/set_up.sh test
	for script in benchmarks/*.py; do $(BIN)/python $$script || exit 1; done

clean:
	rm -rf .venv .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache
