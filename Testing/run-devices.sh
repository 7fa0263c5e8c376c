#!/usr/bin/env bash
# Runs a sample of the tests on other OpenCL implementations, each compared with the system's first
# device, and prints a line for each.
#
#   ./Testing/run-devices.sh [--build-dir DIR] [--long] [NAME]...
#
# NAME: rusticl (Mesa's llvmpipe), intel (Intel's runtime for CPUs), pocl3 (PoCL 3.0 of PyPI); default:
# all. Packages come from Debian and, into a temporary folder, from PyPI. --long: larger cases, double
# precision where the device has it, and each form of the kernels. DIR (build-tests) is what
# Testing/run-tests.sh has built. Status 1: a device failed or gave other bits.
set -uo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
. .ci/packages.sh

build=build-tests
size=small
names=()
while [ $# -gt 0 ]; do
  case "$1" in
    --build-dir) build=${2:-}; shift $(($# > 1 ? 2 : 1)); [ -n "$build" ] || mcor_die "--build-dir needs a name" ;;
    --long) size=; shift ;;
    -h | --help) mcor_help; exit 0 ;;
    rusticl | intel | pocl3) names+=("$1"); shift ;;
    *) mcor_die "unknown argument $1 (see --help)" ;;
  esac
done
[ ${#names[@]} -gt 0 ] || names=(rusticl intel pocl3)
for program in core_bits core_rooms; do
  [ -x "$build/bin/$program" ] || mcor_die "$build/bin/$program is missing; Testing/run-tests.sh builds it"
done

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
trap 'exit 130' INT TERM
mkdir "$scratch/vendors"
failed=0

from_pypi() { # PACKAGE...
  python3 -m venv "$scratch/venv" && "$scratch/venv/bin/pip" install -q --disable-pip-version-check "$@"
}

# Prints the hashes of all cases; what a device without double precision leaves out is not compared.
run() { # NAME SETTING...
  local name=$1 begin=$SECONDS
  shift
  # shellcheck disable=SC2086  # no argument where size is empty
  {
    timeout 3000 env "$@" "$build"/bin/core_bits $size
    timeout 3000 env "$@" "$build"/bin/core_rooms
  } >"$scratch/$name.txt" 2>"$scratch/$name.log"
  echo $((SECONDS - begin)) >"$scratch/$name.seconds"
  grep -v -e '^form' -e ': 0 points' "$scratch/$name.txt" >"$scratch/$name.hashes"
}

compare() { # NAME SETTING...
  local name=$1 same others cases
  run "$@"
  cases=$(wc -l <"$scratch/$name.hashes")
  same=$(grep -c -x -F -f "$scratch/reference.hashes" "$scratch/$name.hashes")
  others=$(grep -v -x -F -f "$scratch/reference.hashes" "$scratch/$name.hashes" | cut -d: -f1 | paste -sd, -)
  printf '%-16s %-18s %d of %d cases have the same bits%s, %s s\n' "$name" \
    "$(sed -n 's/^form //p' "$scratch/$name.txt" | sort -u | paste -sd/ -)" "$same" "$cases" \
    "${others:+ (not: $others)}" "$(cat "$scratch/$name.seconds")"
  if [ "$cases" -eq 0 ] || [ "$same" -lt "$cases" ]; then
    tail -5 "$scratch/$name.log"
    failed=1
  fi
}

compare_forms() { # NAME SETTING...
  local name=$1
  compare "$@"
  if [ -z "$size" ] && [ "$name" != rusticl ]; then
    compare "$name-8" MCOR_LANES=8 "${@:2}"
    compare "$name-gpu" MCOR_DEVICE_FORM=gpu "${@:2}"
  fi
}

vendor() { echo "$1" >"$scratch/vendors/device.icd"; }

run reference
echo "reference: $("$build"/bin/marching-correctors --list-devices 2>/dev/null | head -1)"
[ -s "$scratch/reference.hashes" ] || { cat "$scratch/reference.log"; exit 1; }
for name in "${names[@]}"; do
  case "$name" in
    rusticl)
      mcor_install mesa-opencl-icd || exit 1
      vendor "$(cat /etc/OpenCL/vendors/rusticl.icd)"
      compare_forms rusticl RUSTICL_ENABLE=llvmpipe OCL_ICD_VENDORS="$scratch/vendors" ;;
    intel)
      mcor_install python3-venv || exit 1
      from_pypi intel-opencl-rt intel-cmplr-lib-rt || exit 1
      vendor "$scratch/venv/lib/libintelocl.so"
      compare_forms intel OCL_ICD_VENDORS="$scratch/vendors" LD_LIBRARY_PATH="$scratch/venv/lib" ;;
    pocl3)
      mcor_install python3-venv || exit 1
      from_pypi pocl-binary-distribution || exit 1
      vendor "$(find "$scratch/venv" -name 'libpocl-*.so' | head -1)"
      compare_forms pocl3 OCL_ICD_VENDORS="$scratch/vendors" POCL_CACHE_DIR="$scratch/pocl3" ;;
  esac
done
exit "$failed"
