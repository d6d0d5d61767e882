# Thin names over the CMake presets; `make help` lists them.
RELEASE := build/release
CHECK := build/check
JOBS ?= $(shell nproc)
LONG := 8\.3\.7|8\.5\.5|8\.6\.|8\.7\.| covers|about half|half of all|by chance
VERBOSE_CTEST := --output-on-failure --no-tests=error

.DEFAULT_GOAL := release
.PHONY: release demo check test sanitize build-tests build-sanitized bench format docs install clean help

release: ## Build the program: build/release/gust
	scripts/install-deps build
	cmake --preset release -D BUILD_TESTING=OFF -D GUST_FULL_CHECK=OFF -D GUST_WERROR=OFF
	cmake --build --preset release

demo: release ## Run the demo studies: train, disturb, measure; prints the margins and where the pages lie
	$(RELEASE)/gust run studies/demo-quadrotor.toml --out build/demo-quadrotor.gust
	$(RELEASE)/gust run studies/demo.toml --out build/demo.gust

check: build-tests build-sanitized ## Install, build and run every test, also under sanitizers, each benchmark once, and a minute of each fuzz target
	ctest --test-dir $(CHECK) -j $(JOBS) $(VERBOSE_CTEST)

test: build-tests ## Unit, conformance, golden and style tests without the long ones; some three minutes once it is built
	ctest --test-dir $(CHECK) -j $(JOBS) $(VERBOSE_CTEST) -L 'unit|conformance|golden|style|loop' -E '$(LONG)'

sanitize: build-tests build-sanitized ## Those alone
	ctest --test-dir $(CHECK) -j $(JOBS) $(VERBOSE_CTEST) -L 'sanitizers|fuzz'

build-tests:
	scripts/install-deps check
	scripts/make-venv
	cmake --preset check
	cmake --build --preset check

build-sanitized:
	cmake --preset asan
	cmake --build --preset asan

bench: ## Build and run the benchmarks; JSON in build/bench
	scripts/install-deps bench
	cmake --preset release
	cmake --build --preset release --target benchmarks
	scripts/bench

format: ## Format all C++ in place
	scripts/check-format --fix

docs: release ## Write docs/catalog.md from the program's own catalogue; needs python3
	scripts/make-docs

install: release ## Install under PREFIX (default /usr/local)
	cmake --install $(RELEASE) --prefix $(or $(PREFIX),/usr/local)

clean: ## Remove everything that was built
	rm -rf build

help: ## List these targets
	@awk -F ':.*## ' '/^[a-z]+:.*## /{printf "make %-8s %s\n", $$1, $$2}' Makefile
