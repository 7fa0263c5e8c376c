#!/usr/bin/env bash
# Installs what is needed (Debian 12 or 13; root, or a user with sudo), builds with warnings as
# errors, and runs every test.
#
#   ./Testing/run-tests.sh [--sdk vtk|paraview] [--build-dir DIR] [CTEST ARGUMENTS...]
#
# --sdk chooses on a machine that has neither; plain VTK is the default. DIR: build-tests. Without
# ctest arguments, tests labelled slow are left out; "-L slow" runs those.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
. .ci/packages.sh

sdk=
build="build-tests"
while [ $# -gt 0 ]; do
  case "$1" in
    --sdk) sdk=${2:-}; shift $(($# > 1 ? 2 : 1)); [ -n "$sdk" ] || mcor_die "--sdk is vtk or paraview" ;;
    --build-dir) build=${2:-}; shift $(($# > 1 ? 2 : 1)); [ -n "$build" ] || mcor_die "--build-dir needs a name" ;;
    --help) sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) break ;;
  esac
done

sdk=$(mcor_choose_sdk "$sdk")
# shellcheck disable=SC2046  # the functions print lists of words
mcor_install $(mcor_common_packages) $(mcor_test_packages) $(mcor_sdk_packages "$sdk")

# A build tree that is there already keeps its generator.
export CMAKE_GENERATOR="${CMAKE_GENERATOR:-Ninja}"
# Debian's VTK and ParaView belong to Debian's python3, whatever other python3 is on the PATH.
cmake -Wno-dev -S . -B "$build" -DCMAKE_BUILD_TYPE=Release -DMCOR_BUILD_TESTING=ON \
  -DMCOR_BUILD_EXAMPLES=ON -DMCOR_WERROR=ON -DPython3_EXECUTABLE=/usr/bin/python3 --log-level=WARNING
cmake --build "$build"
[ $# -gt 0 ] || set -- -LE slow
# A virtual display even where there is a real one: pictures then do not depend on its driver.
env -u DISPLAY Testing/with-display.sh \
  ctest --test-dir "$build" --output-on-failure -j "$(nproc)" "$@"
