# Warnings for our own sources; generated code is not held to them.
option(MCOR_WERROR "Treat compiler warnings as errors" OFF)

set(mcor_warnings)
if (NOT MSVC)
  set(mcor_warnings -Wall -Wextra -Wshadow -Wconversion $<$<BOOL:${MCOR_WERROR}>:-Werror>)
  # Products and sums are rounded one by one on processors that could do both at once, too: the same bits everywhere.
  add_compile_options("$<$<COMPILE_LANGUAGE:C,CXX>:-ffp-contract=off>")
endif ()

function (mcor_set_warnings target)
  target_compile_options("${target}" PRIVATE ${mcor_warnings})
endfunction ()
