# Everyday commands. CI calls the same targets.

CONFIG ?= configs/demo.toml
# The demo's store is `dataset`; that of another configuration has its name, or that of its file.
STORE  ?= $(if $(filter configs/demo.toml ./configs/demo.toml,$(CONFIG)),dataset,$(or $(NAME_IN_CONFIG),$(basename $(notdir $(CONFIG)))))
NAME_IN_CONFIG = $(shell sed -n '/^\[/q; s/^name *= *"\([^"/ ]*\)".*/\1/p' $(CONFIG) 2>/dev/null)
MAPS   ?=
JOBS   ?=
SCENES ?=
STAGE  ?=
FORCE  ?=
REDO   ?=
ACCEPT_CODE ?=
GROW   ?=
EDITION ?=
STRICT ?=
EVERY  ?=
NAME   ?=
KEEP   ?=
SEED   ?=
DEST   ?=
SRC    ?=
SCENE  ?=
FRAME  ?=
FRAMES ?=
AGENT  ?=
MODES  ?=
COLOUR ?=
PREDICTIONS ?=
SPLIT  ?=
OUT    ?=
BENCHMARK ?= python/baseline/benchmark.toml
DEVICE ?=
TORCH  ?= cpu
WORKERS ?=
SEEDS ?=
MODELS ?=
PYTHON ?= $(or $(CONVOY_PYTHON),python3)
CARGO ?= cargo
TYPOS ?= typos
BIN    = target/release
MAPS_ARG    = $(if $(MAPS),--maps $(MAPS))
THREADS_ARG = $(if $(JOBS),--threads $(JOBS))
DEVICE_ARG  = $(if $(DEVICE),--device $(DEVICE))
SCENES_ARG  = $(if $(SCENES),--scenes $(SCENES))
FORCE_ARG   = $(if $(FORCE),--force)
REDO_ARG    = $(if $(REDO),--redo) $(if $(ACCEPT_CODE),--accept-code)
EDITION_ARG = $(if $(GROW),--grow) $(if $(EDITION),--edition $(EDITION))
STRICT_ARG  = $(if $(STRICT),--strict)
EVERY_ARG   = $(if $(EVERY),--every $(EVERY))
SEED_ARG    = $(if $(SEED),--seed $(SEED))
SCENE_ARG   = $(if $(SCENE),--scene $(SCENE))
AGENT_ARG   = $(if $(AGENT),--agent $(AGENT))
COMMON      = --config $(CONFIG) --store $(STORE)

.PHONY: docs-site dataset forecast stage scene-video viz preview film stats status verify check view evaluate benchmark export import devkit check-devkit train-check town towns town-pictures check-towns traffic-report gallery build test accept-bytes soak lint bench bench-kernels scale bench-stores test-slurm test-stores test-ray test-kubernetes faults gpus gpu-kit release release-check docs help help-all

# What people use, and all there is.
help:
	@echo "make dataset [CONFIG=configs/demo.toml] [STORE=folder] [MAPS=folder] [JOBS=n] [DEVICE=cpu|gpu|NAME]    (all that is missing or stale)"
	@echo "make forecast      what a configuration comes to: scenes, frames, bytes, time, and what is still to do"
	@echo "make status        a table of scenes and stages [WHY='3 bev-gt']"
	@echo "make stage STAGE=render-sensors [SCENES=3,7-9] [FORCE=1]"
	@echo "make view          plays a store in the browser [STORE=dataset]"
	@echo "make preview       a frame on one sheet [SCENE=0] [FRAME=40] [AGENT=vehicle_0]"
	@echo "make film          a scene as an agent sees it"
	@echo "make export FORMAT=kitti|mcap|nuscenes|opv2v|v2x-real|simbev2x DEST=folder"
	@echo "make evaluate PREDICTIONS=file.parquet"
	@echo "make verify        hashes every shard again; make check holds labels against each other"
	@echo "make release       bundle and wheel (docs/install.md)"
	@echo "make test, lint    what CI runs"
	@echo "make help-all      every target with its variables"

help-all:
	@echo "make dataset [CONFIG=configs/demo.toml] [STORE=folder] [MAPS=folder] [JOBS=n] [DEVICE=cpu|gpu|NAME] [REDO=1] [ACCEPT_CODE=1] [GROW=1] [STRICT=1]    (STORE: dataset for the demo, else the configuration's name)"
	@echo "make forecast                      (same arguments: scenes, frames, bytes and hours to expect)"
	@echo "make stage STAGE=render-sensors [SCENES=3,7-9] [FORCE=1]"
	@echo "make status | stats | verify        (same CONFIG and STORE; status WHY='3 bev-gt': why a stage of a scene is so)"
	@echo "make check [STORE=dataset] [SCENES=3,7-9] [EVERY=10]    (labels against each other; EVERY: some frames only)"
	@echo "make export FORMAT=kitti|mcap|nuscenes|opv2v|v2x-real|simbev2x DEST=folder [STORE=dataset] [SCENES=] [SPLIT=] [ARGS=]    (docs/exports.md; ARGS=--dry-run first)"
	@echo "make import SRC=folder [STORE=dataset] [SCENES=0,3-5] [ARGS=--dry-run]       (a dataset of SimBEV2X as a store: docs/import.md)"
	@echo "make evaluate PREDICTIONS=file.parquet [MASKS=folder] [STORE=dataset] [SCENES=] [SPLIT=] [EVERY=10] [OUT=scores.parquet] (docs/evaluation.md)"
	@echo "make benchmark [DEST=benchmark] [TORCH=cpu|cuda] [JOBS=n]  (data, cooperative models, scores, docs/results.md: docs/python.md; SEEDS=0 MODELS=a,b: a part of it)"
	@echo "make check-devkit [STORE=dataset] [SCENES=0,1] [DEST=pictures]    (nuscenes-devkit on an export of it)"
	@echo "make train-check TRAINER=opencood|heal|v2x-real|mmdet3d|openpcdet [CHECKOUT=folder] [STEPS=200] [HYPES=file] [PYTHON=python3] (docs/trainers.md)"
	@echo "make view [STORE=dataset] [PORT=n]  (plays the scenes of a store in the browser)"
	@echo "make town NAME=convoy/demo [SEED=7] [DEST=folder]       (a road network of our own, with its picture)"
	@echo "make towns DEST=folder                                  (all of them)"
	@echo "make scene-video SCENE=0 [STORE=dataset] [OUT=film.png] (a scene's log from above, animated)"
	@echo "make gallery [DEST=docs/gallery] [MAPS=folder]          (people, vehicles and streets as cameras see them, with a page)"
	@echo "make preview [STORE=dataset] [SCENE=0] [FRAME=40] [AGENT=vehicle_0] [OUT=preview.jpg] (a contact sheet)"
	@echo "make viz [STORE=dataset] [SCENE=0] [FRAMES=0,10-20] [EVERY=n] [AGENT=rsu_*] [MODES='RGB-*,LIDAR3D*'] [COLOUR=height] [DEST=pictures]"
	@echo "make film [STORE=dataset] [SCENE=0] [AGENT=vehicle_0] [EVERY=2] [OUT=film.png]     (and .mp4 with an ffmpeg)"
	@echo "make gpus                           (which GPUs there are, and whether they could be used: docs/gpu.md)"
	@echo "make test | lint | bench | docs     (for developers)"
	@echo "make docs-site                      (all pages as a site, in target/docs-site; pip install mkdocs-material)"
	@echo "make release [DIST=dist] | release-check [DIST=dist] [ROOTS='folder ...'] [NATIVE=program]    (docs/install.md)"

build:
	$(CARGO) build --release --locked --workspace --bins

# Everything that is missing or stale, in order.
dataset: build
	$(BIN)/convoy run $(COMMON) $(MAPS_ARG) $(DEVICE_ARG) $(THREADS_ARG) $(SCENES_ARG) $(EDITION_ARG) $(REDO_ARG) $(FORCE_ARG) $(STRICT_ARG)

# What the plan would come to: scenes, agent-frames, bytes, time, and what of it is still to do. Writes nothing.
forecast: build
	$(BIN)/convoy forecast $(COMMON) $(MAPS_ARG) $(EDITION_ARG) $(STRICT_ARG)

# One stage for some scenes.
stage: build
	@test -n "$(STAGE)" || { echo "say which: make stage STAGE=render-sensors [SCENES=1] [FORCE=1]"; exit 2; }
	$(BIN)/$(STAGE) $(COMMON) $(MAPS_ARG) $(DEVICE_ARG) $(THREADS_ARG) $(SCENES_ARG) $(EDITION_ARG) $(FORCE_ARG) $(REDO_ARG)

stats: build
	$(BIN)/stats $(COMMON) $(THREADS_ARG) $(FORCE_ARG)

# A table of scenes and stages (the program itself exits with 1 while something is not done).
status: build
	@$(BIN)/convoy status $(COMMON) $(MAPS_ARG) $(SCENES_ARG) $(EDITION_ARG) $(STRICT_ARG) $(if $(WHY),--why $(WHY)) || test $$? -eq 1

# Hashes every shard again and names what is missing, truncated or changed.
verify: build
	$(BIN)/convoy verify --store $(STORE)

# Holds the labels of a store against each other, from its files alone: make check STORE=dataset [SCENES=0] [EVERY=10].
check: build
	$(BIN)/convoy check --store $(STORE) $(SCENES_ARG) $(EVERY_ARG) $(THREADS_ARG)

# Plays the scenes of a store in the browser: make view STORE=dataset [PORT=8080].
view: build
	$(BIN)/convoy view $(STORE) $(if $(PORT),--port $(PORT))

# Predicted boxes and BEV masks scored against a store: make evaluate PREDICTIONS=file.parquet [MASKS=folder] [SPLIT=test] [EVERY=10]
# [OUT=scores.parquet]
evaluate: build
	@test -n "$(PREDICTIONS)$(MASKS)" || { echo "say of what: make evaluate PREDICTIONS=file.parquet [MASKS=folder] [STORE=dataset]"; exit 2; }
	$(BIN)/evaluate $(if $(PREDICTIONS),--predictions $(PREDICTIONS)) $(if $(MASKS),--bev-masks $(MASKS)) --store $(STORE) $(SCENES_ARG) $(if $(SPLIT),--split $(SPLIT)) $(EVERY_ARG) \
		$(THREADS_ARG) $(if $(OUT),--out $(OUT)) $(ARGS)

# Makes data, trains models without and with cooperation, scores them, and makes docs/results.md of all runs in docs/results. Started
# again, it goes on. The Python that runs it needs PyTorch: make benchmark [PYTHON=python3] [BENCHMARK=python/baseline/benchmark.toml]
# [STORE=benchmark-store] [DEST=benchmark] [SEEDS=0,1] [MODELS=bevfusion-l,coopdet3d-l] [PAGE=docs/results.md] [ARGS=--forecast].
benchmark: build
	PYTHONPATH=python/src:python/baseline/src $(PYTHON) -m convoy_baseline.benchmark --plan $(BENCHMARK) \
		--store $(if $(filter file,$(origin STORE)),benchmark-store,$(STORE)) --out $(or $(DEST),benchmark) --page $(or $(PAGE),docs/results.md) \
		--program $(BIN)/convoy --device $(TORCH) $(THREADS_ARG) $(if $(WORKERS),--workers $(WORKERS)) \
		$(if $(SEEDS),--seeds $(SEEDS)) $(if $(MODELS),--models $(MODELS)) $(ARGS)

# A finished store in a layout of other people's loaders: make export FORMAT=kitti DEST=folder [SCENES=0,3-5] [SPLIT=train] [ARGS=--dry-run]
export: build
	@test -n "$(FORMAT)" -a -n "$(DEST)" || { echo "say which and where: make export FORMAT=kitti DEST=folder"; exit 2; }
	$(BIN)/export $(FORMAT) --store $(STORE) --dest $(DEST) $(SCENES_ARG) $(if $(SPLIT),--split $(SPLIT)) $(THREADS_ARG) $(ARGS)

# A dataset in SimBEV2X's layout as a store: make import SRC=/data/simbev2x STORE=imported [SCENES=0,3-5]
import: build
	@test -n "$(SRC)" || { echo "say of what: make import SRC=folder [STORE=dataset]"; exit 2; }
	$(BIN)/import simbev2x --source $(SRC) --store $(STORE) $(SCENES_ARG) $(THREADS_ARG) $(FORCE_ARG) $(ARGS)

# nuscenes-devkit in an environment of its own: it wants a numpy before 2.
DEVKIT ?= target/devkit
devkit: $(DEVKIT)/bin/python3
$(DEVKIT)/bin/python3:
	$(PYTHON) -m venv $(DEVKIT)
	$(DEVKIT)/bin/pip install --quiet nuscenes-devkit || { rm -rf $(DEVKIT); exit 1; }

# Exports a store to nuscenes' layout, holds it against the store, opens, draws and evaluates it with nuscenes-devkit:
# make check-devkit STORE=dataset [SCENES=0,1] [DEST=folder for the pictures]
check-devkit: build devkit
	folder=$$(mktemp -d) && \
		$(BIN)/export nuscenes --store $(STORE) --dest $$folder/export $(SCENES_ARG) $(THREADS_ARG) && \
		{ $(PYTHON) tests/exports/nuscenes.py $(STORE) $$folder/export || test $$? -eq 77; } && \
		{ $(DEVKIT)/bin/python3 tests/exports/nuscenes_devkit.py $$folder/export $(or $(DEST),$$folder/pictures) $(STORE) $(BIN)/evaluate || test $$? -eq 77; }; \
		code=$$?; rm -rf $$folder; exit $$code

# A checkout of somebody else's trainer for some steps on a small export (docs/trainers.md): make train-check TRAINER=opencood
# CHECKOUT=/src/OpenCOOD [STEPS=200] [HYPES=its file] [PYTHON=its Python]. Without the checkout or the packages it says so and skips.
train-check: build
	@test -n "$(TRAINER)" || { echo "say which: make train-check TRAINER=opencood|heal|v2x-real|mmdet3d|openpcdet [CHECKOUT=folder]"; exit 2; }
	$(PYTHON) tests/train_check.py $(TRAINER) $(BIN) $(if $(CHECKOUT),--checkout $(CHECKOUT)) --steps $(or $(STEPS),200) \
		$(if $(HYPES),--hypes $(HYPES)) $(ARGS) || test $$? -eq 77

# One of our towns as OpenDRIVE, with a picture.
town: build
	@test -n "$(NAME)" || { echo "say which: make town NAME=convoy/demo [SEED=7] [DEST=folder]"; exit 2; }
	$(BIN)/convoy town --name $(NAME) $(SEED_ARG) --out $(or $(DEST),.)/$(subst /,_,$(NAME)).xodr \
		--picture $(or $(DEST),.)/$(subst /,_,$(NAME)).svg

# A scene's log from above, as an animated picture: make scene-video SCENE=0 [STORE=dataset] [OUT=scene.png]
scene-video: build
	@test -n "$(SCENE)" || { echo "say which: make scene-video SCENE=0 [STORE=dataset] [OUT=scene.png]"; exit 2; }
	$(BIN)/convoy scene-video --store $(STORE) --scene $(SCENE) --out $(or $(OUT),scene-$(SCENE).png)

# Sensor data and labels as pictures, as a contact sheet of a frame, and as a film: docs/pictures.md.
viz: build
	$(BIN)/convoy viz --store $(STORE) $(SCENE_ARG) $(if $(FRAMES),--frames $(FRAMES)) $(EVERY_ARG) $(THREADS_ARG) \
		$(if $(AGENT),--agents '$(AGENT)') $(if $(MODES),--modes '$(MODES)') $(if $(COLOUR),--colour $(COLOUR)) \
		--dest $(or $(DEST),pictures)

preview: build
	$(BIN)/convoy preview --store $(STORE) $(SCENE_ARG) $(if $(FRAME),--frame $(FRAME)) $(AGENT_ARG) $(THREADS_ARG) \
		--out $(or $(OUT),preview.jpg)

film: build
	$(BIN)/convoy film --store $(STORE) $(SCENE_ARG) $(AGENT_ARG) $(EVERY_ARG) $(THREADS_ARG) --out $(or $(OUT),film.png)

towns: build
	@test -n "$(DEST)" || { echo "say where: make towns DEST=folder"; exit 2; }
	$(BIN)/convoy towns --dest $(DEST)

# Everybody and every vehicle on a turntable, and streets in five weathers and three that change, as cameras see them, with a page:
# make gallery [DEST=docs/gallery] [MAPS=folder of CARLA's maps]
gallery: build
	@mkdir -p $(or $(DEST),docs/gallery)
	$(CARGO) run --release --locked -p convoy-sensors --example people -- $(or $(DEST),docs/gallery)
	$(CARGO) run --release --locked -p convoy-sensors --example vehicles -- $(or $(DEST),docs/gallery)
	tests/gallery.sh $(BIN) $(or $(DEST),docs/gallery) $(MAPS)

# The pictures of docs/towns, small enough to be kept there, and the page that shows them.
town-pictures: build
	$(BIN)/convoy towns --pictures docs/towns --size 1000
	@{ printf '# Our towns\n\nWritten by `make town-pictures`; [how towns are made](../towns.md).\n'; \
	for file in lib/map/town/towns/*.toml; do name=$$(basename $$file .toml); \
		printf '\n## convoy/%s\n\n%s\n\n![convoy/%s from above](convoy_%s.svg)\n' \
			$$name "$$(sed -n '1s/^# //p' $$file)" $$name $$name; done; } > docs/towns/README.md

# Reads every town with a reader in Python and with the ASAM quality checker (pip install asam-qc-opendrive).
check-towns: build
	folder=$$(mktemp -d) && $(BIN)/convoy towns --dest $$folder && $(PYTHON) tests/check_towns.py $$folder; \
		code=$$?; rm -rf $$folder; exit $$code

# Raises the numbers of versions.toml and renews the digests of the probes, where shards have other bytes now.
accept-bytes:
	$(CARGO) build --locked --workspace --bins --tests
	$(CARGO) test --locked --workspace --test across -- --ignored --exact --nocapture probes::accept::accept_bytes

# Watches traffic in 28 scenes of 90 s and prints what is wrong with it (docs/traffic.md): make traffic-report
# [ARGS="--seeds 1 --faults Town03"].
traffic-report:
	$(CARGO) run --release --locked -p convoy-traffic --example traffic-report -- $(ARGS)

# The tests across stages run the real programs. These are built together with the tests: built by themselves, other
# people's crates have fewer features, and all that stands on them would be built twice.
test:
	$(CARGO) build --locked --workspace --bins --tests
	$(CARGO) nextest run --locked --workspace --tests --no-fail-fast \
		|| { $(CARGO) nextest --version >/dev/null 2>&1 && exit 1; $(CARGO) test --locked --workspace --tests --no-fail-fast; }
	$(CARGO) test --locked --workspace --doc
	@$(PYTHON) -c 'import numpy, pyarrow' 2>/dev/null \
		|| echo "note: skipped the check that stock readers open a store: it needs numpy and pyarrow for $(PYTHON)"
	@test -d $(or $(CONVOY_TEST_MAPS),../shared/maps) \
		|| echo "note: skipped the tests on real maps: there is no $(or $(CONVOY_TEST_MAPS),../shared/maps)"

# Which GPUs there are, and whether each computes as the CPU does (docs/gpu.md).
gpus:
	$(CARGO) run --quiet --release --locked -p render-sensors -- --device list

# A folder with all that tries a GPU on a machine that has nothing but its driver: make gpu-kit [KIT=gpu-kit].
gpu-kit:
	lib/see/gpu/kit/build.sh $(or $(KIT),gpu-kit)

# Bundle, wheel, list of contents and sums in DIST; needs no network but for packages by their names (docs/install.md).
release:
	release/build.sh $(or $(DIST),dist)

# Installs both where there is no Rust, makes the demo and opens it: make release-check [ROOTS="folder ..."] [NATIVE=program].
release-check:
	ROOTS='$(ROOTS)' NATIVE='$(NATIVE)' CONVOY_PYTHON=$(PYTHON) release/check.sh $(or $(DIST),dist)

# A dataset by two nodes of Slurm on this machine, one of which is lost (docs/clusters.md).
test-slurm: build
	tests/slurm.sh $(BIN)

# A dataset in buckets of the servers that are installed: bytes of the disk's, kills, damage (docs/object-stores.md).
test-stores: build
	tests/stores.sh $(BIN)

# The same by two nodes of Ray; the Python needs it: make test-ray [PYTHON=python3].
test-ray: build
	CONVOY_PYTHON=$(PYTHON) tests/ray.sh $(BIN)

# The manifests of Kubernetes by its schemas, and a dataset by their containers' commands; the Python needs
# kubernetes-validate: make test-kubernetes [PYTHON=python3].
test-kubernetes: build
	CONVOY_PYTHON=$(PYTHON) tests/kubernetes.sh $(BIN)

# Every fault of every operation of a tiny run, on a disk and in a bucket, and what else machines do (docs/reliability.md):
# make faults [FAULTS=1/50/7: a share by a seed, or a try by its name]. Stores lie in memory where there is /dev/shm.
faults: build
	CONVOY_FAULTS='$(or $(FAULTS),all)' CONVOY_FAULTS_TABLE=$(CURDIR)/target/faults.md $(if $(wildcard /dev/shm/.),TMPDIR=/dev/shm) \
		$(CARGO) test --release --locked --workspace --test faults -- --nocapture --test-threads 1
	$(if $(FAULTS),,$(if $(wildcard /dev/shm/.),TMPDIR=/dev/shm) tests/faults.sh $(BIN))

# The property tests with other random cases, again and again: make soak [ROUNDS=20] [CRATE=convoy-town].
soak:
	for round in $$(seq 2 $(or $(ROUNDS),20)); do \
		PROPTEST_RNG_SEED=$$round $(CARGO) nextest run --locked $(if $(CRATE),-p $(CRATE),--workspace) || exit 1; done

lint:
	$(CARGO) fmt --all --check
	$(CARGO) clippy --locked --workspace --all-targets -- -D warnings
	@if typos=$$($(TYPOS) --version 2>&1); then $(TYPOS); \
		else echo "note: spelling is not checked without typos (pip install typos)"; fi
	@if deny=$$($(CARGO) deny --version 2>&1); then $(CARGO) deny --offline check bans licenses sources; \
		else echo "note: licences are not checked without cargo-deny (cargo install --locked cargo-deny)"; fi

# Seconds per agent-frame: each part beside its budget, then whole stages with writing and memory. bench-kernels: every crate's own
# benchmarks.
bench: build
	CONVOY_DEVICE=$(or $(DEVICE),cpu) $(CARGO) bench --locked -p convoy-tests --bench agent_frame --bench stages

bench-kernels:
	$(CARGO) bench --locked -p convoy-opendrive -p convoy-world -p convoy-traffic -p convoy-render \
		-p convoy-sensors -p convoy-codecs --benches
	$(CARGO) bench --locked -p convoy-evaluation --bench many_boxes
	$(CARGO) bench --locked -p convoy-tests --bench labels

# What a bucket costs beside a disk, near and 20 ms away, and what tasks at once ask of it; needs s3s-fs.
bench-stores: build
	python3 tests/bucket_figures.py $(BIN) $(ROUNDS)

# Voxels by class beside the published means, of a scene of each town and of CARLA's maps that there are (docs/scenery.md);
# KEEP names a folder for the store.
shares: build
	$(PYTHON) tests/shares.py $(BIN) "$(MAPS)" $(KEEP)

# Seconds that stores of many scenes cost those who ask about them: make scale [SCENES=10000].
scale: build
	SCENES=$(or $(SCENES),10000) $(CARGO) bench --locked -p convoy-tests --bench scale

# All pages as a site in target/docs-site; needs `pip install mkdocs-material`.
docs-site:
	$(PYTHON) docs/site.py

docs:
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --locked --workspace --no-deps
