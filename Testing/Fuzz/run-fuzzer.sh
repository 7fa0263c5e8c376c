#!/usr/bin/env bash
# Builds the core and the fuzz target with clang's fuzzer, address and undefined behavior sanitizers, and runs them.
# New findings are written to BUILD_DIR/found; a finding is worth keeping in corpus/found/.
# The kernels are compiled as always: under sanitizers a call takes so long that the fuzzer finds nothing. The
# preset `asan` has them under sanitizers, too, for the inputs kept in corpus/.
#
#   Testing/Fuzz/run-fuzzer.sh [SECONDS] [BUILD_DIR] [CLANG]       (60, build-fuzz, clang)
#
# Exit 77 where clang has no fuzzer library (Debian: libclang-rt-14-dev).
set -euo pipefail
here=$(dirname "$(readlink -f "$0")")
seconds=${1:-60}
build=${2:-build-fuzz}
clang=${3:-clang}

mkdir -p "$build/found" "$build/corpus"
build=$(readlink -f "$build")
cat > "$build/probe.c" <<'END'
int LLVMFuzzerTestOneInput(const unsigned char* data, unsigned long size);
int LLVMFuzzerTestOneInput(const unsigned char* data, unsigned long size)
{
  return data && size ? 0 : 0;
}
END
if ! "$clang" -fsanitize=fuzzer,address "$build/probe.c" -o "$build/probe" 2> "$build/probe.log"; then
  echo "$clang has no fuzzer library: $(head -n 1 "$build/probe.log")"
  exit 77
fi

flags="-fsanitize=fuzzer-no-link,address,undefined -fno-omit-frame-pointer"
cmake -S "$here/../.." -B "$build" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_C_COMPILER="$clang" \
  -DCMAKE_C_FLAGS="$flags" -DMCOR_AHEAD_USUAL="cubic;mprime4" -DMCOR_AHEAD_INSTRUCTIONS="V3;BASE" \
  -DMCOR_BUILD_VTK=OFF -DMCOR_BUILD_EXAMPLES=OFF -DMCOR_BUILD_TESTING=ON \
  -DMCOR_BUILD_FUZZER=ON > "$build/configure.log" || { cat "$build/configure.log"; exit 1; }
cmake --build "$build" --target fuzz_extract > "$build/build.log" || { cat "$build/build.log"; exit 1; }

# Leaks: OpenCL drivers keep memory until the process ends.
export FUZZ_FOUND=$build/found/failed-check ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
"$(find "$build" -name fuzz_extract -type f -perm -u+x | head -n 1)" -max_total_time="$seconds" \
  -max_len=512 -timeout=120 -rss_limit_mb=6000 -artifact_prefix="$build/found/" -print_final_stats=1 \
  "$build/corpus" "$here/corpus"
