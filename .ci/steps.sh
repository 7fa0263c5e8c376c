# Scripts source this to run long commands as steps. A step says what it does and how long it takes,
# and ends at Ctrl-C. Bash only.

mcor_die() { echo "$(basename "$0"): $*" >&2; exit 1; }

# Prints the comment on top of the script.
mcor_help() { awk 'NR > 1 { if (!/^#/) exit; sub(/^# ?/, ""); print }' "$0"; }

mcor_stop_step() { # PID can-stop|must-finish
  mcor_interrupted=1
  if [ "$2" = can-stop ]; then
    kill -TERM -- "-$1" 2>/dev/null || true
  else
    echo "  Stopping. This step would leave half an installation, so it is finished first."
  fi
}

# Runs a command whose output nobody needs unless it fails: one line at the start, a sign of life
# every 15 s, one line at the end. The command gets its own process group, so that Ctrl-C reaches
# this shell alone, which then ends the command. "must-finish" lets the command finish first.
mcor_step() { # [must-finish] LABEL COMMAND...
  local stop=can-stop label log pid status=0 start=$SECONDS next=15
  if [ "$1" = must-finish ]; then stop=$1; shift; fi
  label=$1
  shift
  log=$(mktemp)
  echo "$label"
  mcor_interrupted=0
  set -m
  "$@" >"$log" 2>&1 </dev/null &
  pid=$!
  set +m
  # shellcheck disable=SC2064  # the values of now
  trap "mcor_stop_step $pid $stop" INT TERM HUP
  while kill -0 "$pid" 2>/dev/null; do
    sleep 0.2 &
    wait $! || true
    if [ $((SECONDS - start)) -ge "$next" ]; then
      printf '  %3d s: %s\n' "$((SECONDS - start))" "$(tail -n 5 "$log" | tr '\r' '\n' | grep . | tail -n 1 | cut -c 1-90)"
      next=$((SECONDS - start + 15))
    fi
  done
  wait "$pid" || status=$?
  trap - INT TERM HUP
  if [ "$mcor_interrupted" -eq 1 ]; then
    rm -f "$log"
    echo "$(basename "$0"): stopped" >&2
    exit 130
  fi
  if [ "$status" -ne 0 ]; then
    tail -n 60 "$log" >&2
    echo "$(basename "$0"): failed: $label (its last lines are above, all of them in $log)" >&2
    return "$status"
  fi
  if [ $((SECONDS - start)) -ge 5 ]; then printf '  %3d s: done\n' "$((SECONDS - start))"; fi
  rm -f "$log"
}

# Configures and builds for the SDK, plain VTK or ParaView. A build folder holds paths of its SDK, so
# it starts anew for another.
mcor_build() { # FOLDER vtk|paraview CMAKE ARGUMENTS...
  local build=$1 sdk=$2 made_for fresh=() other kept
  shift 2
  # Takes kernels that another build of these sources has compiled already.
  for other in build build-tests; do
    kept=$PWD/$other/vtkMarchingCorrectors/core/ahead
    if [ "$other" != "$build" ] && [ -d "$kept" ]; then set -- "-DMCOR_AHEAD_KEPT=$kept" "$@"; fi
  done
  made_for=$(sed -n 's/^MCOR_SDK:INTERNAL=\([A-Za-z]*\).*/\L\1/p' "$build/CMakeCache.txt" 2>/dev/null || true)
  if [ -n "$made_for" ] && [ "$made_for" != "$sdk" ]; then
    echo "The folder $build was made for another SDK ($made_for): its configuration starts anew"
    fresh=(--fresh)
  fi
  # An existing build tree keeps its generator.
  export CMAKE_GENERATOR="${CMAKE_GENERATOR:-Ninja}"
  # Debian's VTK and ParaView belong to Debian's python3, whatever other python3 is on the PATH.
  mcor_step "Configuring in $build for the SDK: $sdk" cmake "${fresh[@]}" -Wno-dev -S . -B "$build" \
    -DCMAKE_BUILD_TYPE=Release -DMCOR_BUILD_EXAMPLES=ON -DPython3_EXECUTABLE=/usr/bin/python3 \
    -DMCOR_BUILD_PLUGIN="$([ "$sdk" = paraview ] && echo ON || echo OFF)" "$@"
  mcor_step "Building in $build" cmake --build "$build"
}

# Prints ctest's lines as they come and, while none comes, which tests are running.
mcor_show_tests() { # SECONDS OF SILENCE
  local line= part= status name
  declare -A since=()
  while :; do
    status=0
    IFS= read -r -t "$1" part || status=$?
    line+=$part
    if [ "$status" -gt 128 ]; then
      for name in "${!since[@]}"; do
        echo "      ... $name is running, $((SECONDS - since[$name])) s so far"
      done
      continue
    fi
    [ "$status" -eq 0 ] || break
    printf '%s\n' "$line"
    if [[ $line =~ ^\ *Start\ +[0-9]+:\ (.*)$ ]]; then
      since[${BASH_REMATCH[1]}]=$SECONDS
    elif [[ $line =~ Test\ +#[0-9]+:\ ([^ ]+) ]]; then
      unset "since[${BASH_REMATCH[1]}]"
    fi
    line=
  done
  printf '%s' "$line"
}
