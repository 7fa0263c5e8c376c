# Runs PROGRAM with each of SETTINGS (NAME=VALUE or --unset=NAME) in the environment; all must print
# the same, but for lines that begin with "form": they say in what form the kernels ran. With FORMS,
# at least two forms must have run, or nothing was compared.
#   cmake -DPROGRAM=... "-DSETTINGS=MCOR_LANES=1;MCOR_LANES=8" -DFORMS=ON -P same_bits.cmake
set(seen "")
foreach (setting IN LISTS SETTINGS)
  execute_process(
    COMMAND "${CMAKE_COMMAND}" -E env "${setting}" "${PROGRAM}"
    OUTPUT_VARIABLE output RESULT_VARIABLE result)
  if (NOT result EQUAL 0)
    message(FATAL_ERROR "With ${setting} ${PROGRAM} failed: ${result}\n${output}")
  endif ()
  string(REGEX MATCHALL "form [^\n]*" forms "${output}")
  list(REMOVE_DUPLICATES forms)
  string(REPLACE ";" ", " forms "${forms}")
  string(REGEX REPLACE "form [^\n]*\n" "" output "${output}")
  message("${setting}: ${forms}")
  if (NOT DEFINED expected)
    set(expected "${output}")
    message("${expected}")
  elseif (NOT output STREQUAL expected)
    message(SEND_ERROR "With ${setting} the result is another one:\n${output}")
  endif ()
  list(APPEND seen "${forms}")
endforeach ()
list(REMOVE_DUPLICATES seen)
list(LENGTH seen count)
if (FORMS AND count LESS 2)
  message(FATAL_ERROR "Only one form ran, \"${seen}\": nothing was compared.")
endif ()
