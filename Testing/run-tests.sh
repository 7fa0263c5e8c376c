#!/usr/bin/env bash
# Installs what is needed (Debian 12 or 13; root, or a user with sudo), builds with warnings as
# errors, and runs the tests.
#
#   ./Testing/run-tests.sh [--sdk vtk|paraview] [--build-dir DIR] [-L | -LE | -R | -E PATTERN]...
#                          [--twice] [-- CTEST ARGUMENTS...]
#
# --sdk chooses on a machine that has neither; plain VTK is the default. DIR: build-tests. The
# patterns choose tests as ctest's do, by label (-L, -LE) or name (-R, -E); any other argument of
# ctest goes behind --. Without any of them, tests labelled slow are left out; "-L slow" runs those.
# --twice: before, the core's, the oracle's and VTK's tests on PoCL, which checks the built-in device.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
. .ci/packages.sh

sdk=
build="build-tests"
tests=()
twice=
while [ $# -gt 0 ]; do
  case "$1" in
    --sdk) sdk=${2:-}; shift $(($# > 1 ? 2 : 1)); [ -n "$sdk" ] || mcor_die "--sdk is vtk or paraview" ;;
    --build-dir) build=${2:-}; shift $(($# > 1 ? 2 : 1)); [ -n "$build" ] || mcor_die "--build-dir needs a name" ;;
    --twice) twice=1; shift ;;
    -h | --help) mcor_help; exit 0 ;;
    -L | -LE | -R | -E) [ $# -ge 2 ] || mcor_die "$1 needs a pattern"; tests+=("$1" "$2"); shift 2 ;;
    --) shift; tests+=("$@"); break ;;
    *) mcor_die "unknown option $1 (see --help)" ;;
  esac
done
[ ${#tests[@]} -gt 0 ] || tests=(-LE slow)

sdk=$(mcor_choose_sdk "$sdk")
# shellcheck disable=SC2046  # the functions print lists of words
mcor_install $(mcor_common_packages) $(mcor_test_packages) $(mcor_sdk_packages "$sdk")
mcor_mend_sdk "$sdk"
mcor_build "$build" "$sdk" -DMCOR_BUILD_TESTING=ON -DMCOR_WERROR=ON

test_names() { ctest --test-dir "$build" -N "$@" | sed -n 's/^ *Test *#[0-9]*: //p' | sort; }

# What this run does not try: tests that the arguments leave out, and those that lack a program here.
say_what_is_left_out() {
  local left_out
  mapfile -t left_out < <(comm -23 <(test_names) <(test_names "${tests[@]}"))
  if [ ${#left_out[@]} -gt 12 ]; then left_out=("${#left_out[@]} tests"); fi
  [ ${#left_out[@]} -eq 0 ] || echo "Left out by ${tests[*]}: ${left_out[*]}"
  sed 's/^/Not possible here: /' "$build/Testing/tests_not_here.txt"
}

# A virtual display even where there is a real one: pictures then do not depend on its driver.
run_tests() {
  env -u DISPLAY Testing/with-display.sh \
    ctest --test-dir "$build" --output-on-failure --no-tests=error -j "$(nproc)" "$@" | mcor_show_tests 60
}

failed=0
if [ -n "$twice" ]; then
  echo "On PoCL:"
  MCOR_DEVICE=pocl run_tests -L "unit|oracle|vtk" -LE "slow|pocl" || failed=1
fi
say_what_is_left_out
run_tests "${tests[@]}" || failed=1
exit "$failed"
