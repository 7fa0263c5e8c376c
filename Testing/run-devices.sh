#!/usr/bin/env bash
# Runs a sample of the tests on several OpenCL implementations, each compared with the system's PoCL,
# and prints a line for each.
#
#   ./Testing/run-devices.sh [--build-dir DIR] [--long] [NAME]...
#
# NAME: built-in, rusticl (Mesa's llvmpipe), intel (Intel's runtime for CPUs), pocl3 (PoCL 3.0 of PyPI),
# arm64 (the built-in device, compiled for that processor, which is emulated); default: all. Packages come from
# Debian and, into a temporary folder, from PyPI. --long: larger cases, double precision where the device has it
# (the built-in one is compiled anew with it), and each form of the kernels. DIR (build-tests) is what
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
    built-in | rusticl | intel | pocl3 | arm64) names+=("$1"); shift ;;
    *) mcor_die "unknown argument $1 (see --help)" ;;
  esac
done
[ ${#names[@]} -gt 0 ] || names=(built-in rusticl intel pocl3 arm64)
for program in core_bits core_modules; do
  [ -x "$build/bin/$program" ] || mcor_die "$build/bin/$program is missing; Testing/run-tests.sh builds it"
done

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
trap 'exit 130' INT TERM
mkdir "$scratch/vendors" "$scratch/none"
failed=0
programs=("$build/bin") # the programs' folder, behind a command that runs them

from_pypi() { # PACKAGE...
  python3 -m venv "$scratch/venv" && "$scratch/venv/bin/pip" install -q --disable-pip-version-check "$@"
}

# Writes the hashes of all cases, but not of cases that a device without double precision leaves out.
run() { # NAME SETTING...
  local name=$1 begin=$SECONDS
  shift
  # shellcheck disable=SC2086  # no argument where size is empty
  {
    timeout 3000 env "$@" "${programs[@]}"/core_bits $size
    timeout 3000 env "$@" "${programs[@]}"/core_modules
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
    [ "$name" = built-in ] || compare "$name-gpu" MCOR_DEVICE_FORM=gpu "${@:2}"
  fi
}

# Builds the core and its tests with all kernels of the built-in device.
build_core() { # FOLDER CMAKE ARGUMENTS...
  cmake -S . -B "$scratch/$1" -G Ninja -Wno-dev -DCMAKE_BUILD_TYPE=Release -DMCOR_BUILD_VTK=OFF \
    -DMCOR_BUILD_EXAMPLES=OFF -DMCOR_AHEAD=all "${@:2}" &&
    cmake --build "$scratch/$1" --target core_bits core_modules
}

# Builds for arm64 with clang and Debian's arm64 libraries. The test library comes from an arm64 package; this
# system's packages do not change.
build_arm64() {
  local apt=(apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o APT::Sandbox::User=
    -o "Dir::State=$scratch/apt" -o "Dir::State::status=$scratch/apt/status" -o "Dir::Cache=$scratch/apt")
  mkdir -p "$scratch/apt/lists/partial" "$scratch/apt/archives/partial" "$scratch/arm64" &&
    touch "$scratch/apt/status" && "${apt[@]}" update &&
    (cd "$scratch/apt" && "${apt[@]}" download libcmocka-dev libcmocka0) || return 1
  for package in "$scratch"/apt/*.deb; do dpkg -x "$package" "$scratch/arm64" || return 1; done
  build_core build -DMCOR_AHEAD_TRIPLE=aarch64-linux-gnu \
    -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 \
    -DCMAKE_C_COMPILER=clang -DCMAKE_C_COMPILER_TARGET=aarch64-linux-gnu \
    -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_CXX_COMPILER_TARGET=aarch64-linux-gnu \
    -Dcmocka_DIR="$scratch/arm64/usr/lib/aarch64-linux-gnu/cmake/cmocka"
}

vendor() { echo "$1" >"$scratch/vendors/device.icd"; }

run reference MCOR_DEVICE=pocl
echo "reference: PoCL"
[ -s "$scratch/reference.hashes" ] || { cat "$scratch/reference.log"; exit 1; }
for name in "${names[@]}"; do
  case "$name" in
    built-in)
      if [ -z "$size" ]; then
        build_core double >"$scratch/build.log" 2>&1 || { tail -20 "$scratch/build.log"; exit 1; }
        programs=("$scratch/double/bin")
      fi
      compare_forms built-in OCL_ICD_VENDORS="$scratch/none"
      programs=("$build/bin") ;;
    arm64)
      mcor_install clang gcc-aarch64-linux-gnu g++-aarch64-linux-gnu qemu-user || exit 1
      build_arm64 >"$scratch/build.log" 2>&1 || { tail -20 "$scratch/build.log"; exit 1; }
      programs=(qemu-aarch64 -L /usr/aarch64-linux-gnu "$scratch/build/bin")
      compare arm64 QEMU_SET_ENV="LD_LIBRARY_PATH=$scratch/arm64/usr/lib/aarch64-linux-gnu"
      programs=("$build/bin") ;;
    rusticl)
      mcor_install mesa-opencl-icd || exit 1
      vendor "$(cat /etc/OpenCL/vendors/rusticl.icd)"
      compare_forms rusticl MCOR_DEVICE=1 RUSTICL_ENABLE=llvmpipe OCL_ICD_VENDORS="$scratch/vendors" ;;
    intel)
      mcor_install python3-venv || exit 1
      from_pypi intel-opencl-rt intel-cmplr-lib-rt || exit 1
      vendor "$scratch/venv/lib/libintelocl.so"
      compare_forms intel MCOR_DEVICE=1 OCL_ICD_VENDORS="$scratch/vendors" LD_LIBRARY_PATH="$scratch/venv/lib" ;;
    pocl3)
      mcor_install python3-venv || exit 1
      from_pypi pocl-binary-distribution || exit 1
      vendor "$(find "$scratch/venv" -name 'libpocl-*.so' | head -1)"
      compare_forms pocl3 MCOR_DEVICE=1 OCL_ICD_VENDORS="$scratch/vendors" POCL_CACHE_DIR="$scratch/pocl3" ;;
  esac
done
exit "$failed"
