# Everything happens in .venv, made and filled on the first run. Needs Python 3.11 or newer, pip and make.

VENV := .venv
BIN := $(VENV)/bin

ifdef ROS_DISTRO
# A sourced ROS wins: its Python, its rclpy, and the numpy that rclpy was compiled for.
PYTHON ?= python3
ROS := $(ROS_DISTRO)
VENV_OPTIONS := --system-site-packages
EXTRAS := sim
DEV_EXTRAS := sim,dev
PINS = $(VENV)/numpy-of-$(ROS).txt
else
# 3.11 where there is one: the newest Python that PyBullet has wheels for.
PYTHON ?= $(shell python3.11 -c 'import sys; print(sys.executable)' 2>/dev/null || echo python3)
ROS := wheels
EXTRAS := ros,sim
# The learned models are tested where the pins keep torch to one release.
DEV_EXTRAS := ros,sim,learn,open-vocabulary,dev
PINS = constraints.txt
endif

# Each stamp is named after the ROS it was made for: sourcing another one makes .venv anew.
MADE := $(VENV)/.made-for-$(ROS)
RUN_READY := $(VENV)/.run-ready-$(ROS)
DEV_READY := $(VENV)/.dev-ready-$(ROS)

# pip copies package.xml, config and launch into .venv also from an editable install.
INSTALLED := pyproject.toml constraints.txt hatch_build.py \
	$(wildcard */package.xml robustnav_nodes/config/* robustnav_nodes/launch/*)

# These run all nodes of a search as processes, in real time: nothing else may want the cores.
WHOLE_GRAPHS := tests/graph/test_one_process.py tests/graph/test_search.py

say = @echo "==> $(1)"
pip_install = $(BIN)/python -m pip install --quiet --disable-pip-version-check -c $(PINS) --editable '.[$(1)]'

.DEFAULT_GOAL := help
.NOTPARALLEL:
.DELETE_ON_ERROR:
.PHONY: demo test bench check samples docs clean help

demo: $(RUN_READY) ## run a search in a simulated home; ARGS="--scenario follow --user human"
	$(call say,Starting the demo)
	@$(BIN)/robustnav demo $(ARGS)

# pip would compile all of torch and transformers for them; Python compiles what is loaded, and may keep it here.
test check: export PYTHONDONTWRITEBYTECODE :=

test: $(DEV_READY) ## run the tests; ARGS="-m slow" or ARGS="tests/belief -k entropy"
	$(call say,Running the tests)
ifdef ARGS
	@$(BIN)/python -m pytest $(ARGS)
else
	@$(BIN)/python -m pytest --numprocesses auto --dist loadfile $(addprefix --ignore=,$(WHOLE_GRAPHS))
	$(call say,Running the tests of whole graphs: they need every core)
	@$(BIN)/python -m pytest $(WHOLE_GRAPHS)
endif

bench: $(RUN_READY) ## compare the planners on scenes made by seed; ARGS="--suite hard-noisy --episodes 200"
	@$(BIN)/robustnav bench search $(or $(ARGS),--episodes 40)

check: $(DEV_READY) ## lint, format, types, and that the generated tables agree with the code
	$(call say,Checking the style with ruff)
	@$(BIN)/ruff check .
	$(call say,Checking the format with ruff)
	@$(BIN)/ruff format --check .
	$(call say,Checking the types with mypy)
	@$(BIN)/mypy
	$(call say,Checking that the generated tables agree with the code)
	@$(BIN)/python -m robustnav_nodes.docs --check

samples: $(RUN_READY) ## record the runs in bags/samples anew: after a change that they do not survive
	$(call say,Recording the samples)
	@rm -rf runs/samples
	@$(BIN)/robustnav demo --lockstep --seed 6 --params bags/samples/small.yaml --bag runs/samples/search
	@rm -rf bags/samples/search
	@mv runs/samples/search bags/samples/search

docs: $(DEV_READY) ## write the generated tables anew
	$(call say,Writing the generated tables)
	@$(BIN)/python -m robustnav_nodes.docs

clean: ## remove .venv and everything that tools leave behind
	$(call say,Removing the virtual environment and caches)
	@rm -rf $(VENV) .mypy_cache .pytest_cache .ruff_cache .hypothesis dist
	@find . -name __pycache__ -type d -prune -exec rm -rf {} +

help: ## list what make can do here
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-7s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

$(MADE):
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
		echo "robustnav needs Python 3.11 or newer, and '$(PYTHON)' is none: make PYTHON=/path/to/python3.11" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' || { \
		echo "'$(PYTHON)' has no venv module: install it (Debian, Ubuntu: apt install python3-venv)" >&2; exit 1; }
	$(call say,Making the virtual environment $(VENV) with $(PYTHON) (ROS: $(ROS)))
	@$(PYTHON) -m venv --clear $(VENV_OPTIONS) $(VENV)
ifdef ROS_DISTRO
	@$(BIN)/python -c 'import numpy; print(f"numpy=={numpy.__version__}")' > $(PINS)
endif
	@$(BIN)/python -c 'import sys; sys.exit(sys.version_info >= (3, 12))' || \
		echo "==> PyBullet has no wheel for this Python: pip will compile it, which takes minutes and needs g++"
	@touch $@

$(RUN_READY): $(MADE) $(INSTALLED)
	$(call say,Installing robustnav and what it runs on (the first time takes a minute or two))
	@$(call pip_install,$(EXTRAS))
	@touch $@

$(DEV_READY): $(MADE) $(INSTALLED)
	$(call say,Installing robustnav and the tools for its development (the first time takes a minute or two))
	@$(call pip_install,$(DEV_EXTRAS)) --no-compile
	@touch $@ $(RUN_READY)
