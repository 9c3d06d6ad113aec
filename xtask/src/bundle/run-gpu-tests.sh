#!/usr/bin/env bash
# Runs raywarp's tests on the GPU of this machine. Usage: run-gpu-tests.sh [WORDS FOR THE TESTS...]
set -uo pipefail
cd "$(dirname "$0")" || exit 2
export RAYWARP_TEST_DEVICE=cuda RAYWARP_SCENES="$PWD/scenes"

./raywarp doctor

log=$(mktemp)
trap 'rm -f "$log"' EXIT
passed=0 failed=0
for test in tests/*; do
    echo "== $test"
    "$test" "$@" 2>&1 | tee "$log"
    status=${PIPESTATUS[0]}
    result=$(grep -E '^test result:' "$log" | tail -1)
    passes=$(sed -nE 's/.* ([0-9]+) passed.*/\1/p' <<<"$result")
    failures=$(sed -nE 's/.* ([0-9]+) failed.*/\1/p' <<<"$result")
    # A test program that died before its summary is one failure.
    [ "$status" -ne 0 ] && [ "${failures:-0}" -eq 0 ] && failures=1
    passed=$((passed + ${passes:-0}))
    failed=$((failed + ${failures:-0}))
done

echo
if [ $((passed + failed)) -eq 0 ]; then
    echo "no test ran: is there one of that name?"
    exit 1
fi
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
