# Sets warnings for our own sources, not for generated code.
option(MCOR_WERROR "Treat compiler warnings as errors" OFF)

set(mcor_warnings)
if (NOT MSVC)
  set(mcor_warnings -Wall -Wextra -Wshadow -Wconversion $<$<BOOL:${MCOR_WERROR}>:-Werror>)
  # Products and sums are rounded one by one, also by processors that could do both at once, so bits are the same everywhere.
  add_compile_options("$<$<COMPILE_LANGUAGE:C,CXX>:-ffp-contract=off>")
endif ()

function (mcor_set_warnings target)
  target_compile_options("${target}" PRIVATE ${mcor_warnings})
endfunction ()
