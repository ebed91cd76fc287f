# Conic's commands: `make` lists them. Each sets up what it needs, once; the pins are in pyproject.toml.
BLENDERS := 4.2 4.5 5.0 5.2
PYTHON := .venv/bin/python
export MESA_SHADER_CACHE_DIR ?= $(CURDIR)/build/mesa-shader-cache
$(shell mkdir -p $(MESA_SHADER_CACHE_DIR))

help:  ## list these commands
	@sed -n 's/^\([a-z-]*\):.*##/  make \1\t/p' $(MAKEFILE_LIST) | expand -t 18

render: .venv/.ready  ## render the first picture in Blender: build/first_picture.png
	$(PYTHON) examples/first_picture.py --output build/first_picture.png

molecules: .venvs/molecules/.ready  ## render Molecular Nodes' styles of 47,681 atoms: build/molecular_nodes.png
	.venvs/molecules/bin/python examples/molecular_nodes.py --output build/molecular_nodes.png

test: .venv/.ready  ## run the tests: without Blender, shaders, pictures, in Blender as a module
	@tools/setup programs povray
	$(PYTHON) -m pytest tests

test-all: $(BLENDERS:%=test-bpy-%)  ## run the tests in Blender as a module, in each version of BLENDERS

test-app: .venv/.ready  ## run the tests in the real Blender application, OpenGL and Vulkan
	tools/run_app_tests

torture: .venv/.ready  ## edit in each mode, and at random for five minutes, in the application's rendered viewport
	CONIC_ALL_MODES=1 CONIC_TORTURE_SECONDS=300 tools/run_app_tests opengl -- \
		tests/app/test_torture.py tests/app/test_viewport_modes.py -q

lint: .venv/.ready  ## check the Python code's style
	$(PYTHON) -m ruff check .
	$(PYTHON) -m ruff format --check .

zip: .venv/.ready  ## build and validate the extension: dist/conic-<version>.zip
	$(PYTHON) tools/make_zip.py dist

bench: .venvs/bench/.ready  ## measure Conic and its peers side by side, with plots: build/bench
	@tools/setup programs povray tachyon || true  # a peer that is missing is named in the table
	.venvs/bench/bin/python -m benchmarks all

clean:  ## remove what was built; the environments (.venv, .venvs) stay
	rm -rf build dist

$(BLENDERS:%=test-bpy-%): test-bpy-%: .venvs/bpy-%/.ready
	.venvs/bpy-$*/bin/python -m pytest tests/blender

.venv/.ready: pyproject.toml tools/setup
	@tools/setup default

$(BLENDERS:%=.venvs/bpy-%/.ready): .venvs/bpy-%/.ready: pyproject.toml tools/setup
	@tools/setup environment $*

.venvs/molecules/.ready: pyproject.toml tools/setup
	@tools/setup molecules

.venvs/bench/.ready: pyproject.toml tools/setup
	@tools/setup bench

.PHONY: help render molecules test test-all test-app torture lint zip bench clean $(BLENDERS:%=test-bpy-%)
