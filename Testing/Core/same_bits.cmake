# Runs PROGRAM as it is and with each of SETTINGS (NAME=VALUE) in the environment; all outputs must be
# the same.
#   cmake -DPROGRAM=... "-DSETTINGS=MCOR_LANES=1;MCOR_LANES=8" -P same_bits.cmake
execute_process(COMMAND "${PROGRAM}" OUTPUT_VARIABLE expected RESULT_VARIABLE result)
if (NOT result EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} failed: ${result}")
endif ()
message("${expected}")
foreach (setting IN LISTS SETTINGS)
  execute_process(
    COMMAND "${CMAKE_COMMAND}" -E env "${setting}" "${PROGRAM}"
    OUTPUT_VARIABLE output RESULT_VARIABLE result)
  if (NOT result EQUAL 0 OR NOT output STREQUAL expected)
    message(SEND_ERROR "With ${setting} the result (${result}) is another one:\n${output}")
  endif ()
endforeach ()
