#!/usr/bin/env bash
# Installs what is needed (Debian 12 or 13; root, or a user with sudo), builds with warnings as
# errors, and runs the tests.
#
#   ./Testing/run-tests.sh [--sdk vtk|paraview] [--build-dir DIR] [-L | -LE | -R | -E PATTERN]...
#                          [--pocl] [-- CTEST ARGUMENTS...]
#
# --sdk chooses on a machine that has neither; plain VTK is the default. DIR: build-tests. The
# patterns choose tests as ctest's do, by label (-L, -LE) or name (-R, -E); any other argument of
# ctest goes behind --. Without arguments for ctest, tests labelled slow are left out; "-L slow" runs the slow ones.
# --pocl: the core's, the oracle's and VTK's tests run on PoCL first, which checks the built-in device; then all others run.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
. .ci/packages.sh

sdk=
build="build-tests"
tests=()
left_out=()
pocl=
while [ $# -gt 0 ]; do
  case "$1" in
    --sdk) sdk=${2:-}; shift $(($# > 1 ? 2 : 1)); [ -n "$sdk" ] || mcor_die "--sdk is vtk or paraview" ;;
    --build-dir) build=${2:-}; shift $(($# > 1 ? 2 : 1)); [ -n "$build" ] || mcor_die "--build-dir needs a name" ;;
    --pocl) pocl=1; shift ;;
    -h | --help) mcor_help; exit 0 ;;
    -L | -R | -E) [ $# -ge 2 ] || mcor_die "$1 needs a pattern"; tests+=("$1" "$2"); shift 2 ;;
    -LE) [ $# -ge 2 ] || mcor_die "$1 needs a pattern"; left_out+=("$2"); shift 2 ;;
    --) shift; break ;;
    *) mcor_die "unknown option $1 (see --help)" ;;
  esac
done
[ $((${#tests[@]} + ${#left_out[@]} + $#)) -gt 0 ] || left_out=(slow)

sdk=$(mcor_choose_sdk "$sdk")
# shellcheck disable=SC2046  # the functions print lists of words
mcor_install $(mcor_common_packages) $(mcor_test_packages) $(mcor_sdk_packages "$sdk")
mcor_mend_sdk "$sdk"
mcor_build "$build" "$sdk" -DMCOR_BUILD_TESTING=ON -DMCOR_WERROR=ON

# Joins patterns, because ctest would leave out only tests that match all of several patterns.
without() { local IFS="|"; [ $# -eq 0 ] || printf -- '-LE\n%s\n' "$*"; }
mapfile -t rest < <(without "${left_out[@]}")

test_names() { ctest --test-dir "$build" -N "$@" | sed -n 's/^ *Test *#[0-9]*: //p' | sort; }

# Lists what this run does not try: tests that the arguments leave out, and tests that lack a program here.
say_what_is_left_out() {
  local names
  mapfile -t names < <(comm -23 <(test_names) <(test_names "$@"))
  if [ ${#names[@]} -gt 12 ]; then names=("${#names[@]} tests"); fi
  [ ${#names[@]} -eq 0 ] || echo "Left out by $*: ${names[*]}"
  sed 's/^/Not possible here: /' "$build/Testing/tests_not_here.txt"
}

# Uses a virtual display even if there is a real one, so that pictures do not depend on its driver.
run_tests() {
  env -u DISPLAY Testing/with-display.sh \
    ctest --test-dir "$build" --output-on-failure -j "$(nproc)" "$@" | mcor_show_tests 60
}

say_what_is_left_out "${tests[@]}" "${rest[@]}" "$@"
if [ -z "$pocl" ]; then
  run_tests --no-tests=error "${tests[@]}" "${rest[@]}" "$@"
  exit
fi
failed=0
echo "On PoCL:"
MCOR_DEVICE=pocl run_tests --no-tests=ignore -L "unit|oracle|vtk" "${tests[@]}" "${rest[@]}" "$@" || failed=1
echo "The others:"
mapfile -t rest < <(without "${left_out[@]}" unit oracle vtk)
run_tests --no-tests=ignore "${tests[@]}" "${rest[@]}" "$@" || failed=1
exit "$failed"
