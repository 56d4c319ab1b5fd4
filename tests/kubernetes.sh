#!/usr/bin/env bash
# The manifests of `convoy submit` are held against Kubernetes' own schemas; then their containers' commands
# run here, index by index, by a stand-in for kubectl: one is killed and one is told to stop. The dataset has
# the bytes of one machine. Usage: tests/kubernetes.sh FOLDER_OF_PROGRAMS
# A second dataset is made so in a bucket, if `s3s-fs` is installed.
# Needs an interpreter with kubernetes-validate (pip install kubernetes-validate; CONVOY_PYTHON names it) and
# some fifteen minutes. No Kubernetes is started: none can be had on a machine without containers.
set -euo pipefail
bin=$(realpath "$1")
here=$(realpath "$(dirname "$0")")
source "$here/cluster.sh"
export PYTHON=${CONVOY_PYTHON:-python3}
"$PYTHON" -c 'import kubernetes_validate' 2>/dev/null ||
    { echo "note: skipped, $PYTHON has no kubernetes-validate"; exit 0; }
work=$(mktemp -d)
mkdir "$work/log"
servers=()
stop() {
    [[ ${#servers[@]} == 0 ]] || kill "${servers[@]}" 2>/dev/null || true
    [[ -n ${KEEP:-} ]] || rm -rf "$work"
}
trap stop EXIT
configure
submit() { "$bin/convoy" submit --engine kubernetes --config "$work/set.toml" --image convoy:test "$@"; }

# Whatever the options are, the manifests are those of Kubernetes.
submit --store s3://sets/cluster --to "$work/url" --secret sets --namespace lab --tasks 6 --at-once 2
submit --store /data/sets/cluster --volume-claim sets:/data --to "$work/split" --split render-sensors=gpu
"$PYTHON" "$here/kubernetes.py" validate "$work"/url/*.yaml "$work"/split/*.yaml
# What cannot be is said before anything is written.
for wrong in "--store $work/none" "--store s3://sets/none --partition cpu" "--store s3://sets/none --tasks 100001"; do
    code=0
    # shellcheck disable=SC2086
    submit $wrong --to "$work/none-jobs" || code=$?
    [[ $code == 2 && ! -e $work/none && ! -e $work/none-jobs ]] || { echo "exit $code: $wrong"; exit 1; }
done
code=0
PATH=/nowhere "$bin/convoy" submit --engine kubernetes --config "$work/set.toml" --image convoy:test \
    --store s3://sets/none --to "$work/none-jobs" --submit || code=$?
[[ $code == 2 && ! -e $work/none-jobs ]] || { echo "without kubectl: exit $code"; exit 1; }

# The stand-in is what the script calls.
mkdir "$work/bin" "$work/cluster"
printf '#!/bin/sh\nexec "$PYTHON" "%s/kubernetes.py" "$@"\n' "$here" >"$work/bin/kubectl"
chmod +x "$work/bin/kubectl"
export PATH=$work/bin:$bin:$PATH STAND_IN=$work/cluster
STAND_IN_KILL=2 STAND_IN_TERM=4 submit --store "$work/store" --volume-claim sets --to "$work/jobs" --tasks 6 \
    --cores 1 --memory 2 --submit 2>&1 | tee "$work/told"
grep -q 'index 2: exit 137, again' "$work/told"
grep -q 'index 4: exit 75, again' "$work/told"
# Its last words are about nodes.
compare | sed '$d'
echo "the dataset of the containers' commands, of which one was killed and one stopped, has the bytes of one machine"

# The same in a bucket, which they get to by the secret alone.
if command -v s3s-fs >/dev/null; then
    mkdir -p "$work/s3/sets" "$work/cluster-s3"
    s3s-fs --host 127.0.0.1 --port 18019 --access-key test --secret-key testsecret "$work/s3" >"$work/log/s3" 2>&1 &
    servers+=($!)
    cat >"$work/secret.yaml" <<YAML
apiVersion: v1
kind: Secret
metadata: {name: bucket}
stringData:
  AWS_ACCESS_KEY_ID: test
  AWS_SECRET_ACCESS_KEY: testsecret
  AWS_REGION: us-east-1
  AWS_ENDPOINT_URL: http://127.0.0.1:18019
YAML
    export STAND_IN=$work/cluster-s3
    kubectl apply -f "$work/secret.yaml"
    STAND_IN_KILL=3 STAND_IN_TERM=1 submit --store s3://sets/cluster --secret bucket --to "$work/jobs-s3" --tasks 6 \
        --cores 1 --memory 2 --submit 2>&1 | tee "$work/told"
    grep -q 'index 3: exit 137, again' "$work/told"
    grep -q 'index 1: exit 75, again' "$work/told"
    # s3s-fs leaves folders in which nothing is any more.
    find "$work/s3/sets/cluster" -depth -type d -empty -delete
    diff -r "$work/s3/sets/cluster" "$work/alone"
    ! grep -rq testsecret "$work/jobs-s3" "$work/s3/sets" || { echo "error: the secret is written somewhere"; exit 1; }
    echo "and the same in a bucket"
    export STAND_IN=$work/cluster
else
    echo "note: no bucket was tried, s3s-fs is not installed"
fi

# Started again it has nothing to do; and another configuration, which nobody can be asked about, is no plan.
bash "$work/jobs/submit.sh"
[[ $(grep -c ': 0 scenes to make' "$work/cluster/cluster-scenes.log") == 6 ]]
sed -i 's/seed = 5/seed = 6/' "$work/set.toml"
printf '[store]\nask_beyond_s = 1\n' >>"$work/set.toml"
code=0
submit --store "$work/store" --volume-claim sets --to "$work/jobs" --tasks 6 --cores 1 --submit || code=$?
[[ $code == 1 ]]
diff -r "$work/store" "$work/alone"
