# Warnings for our own sources; generated wrapping code is not held to them.
option(MCOR_WERROR "Treat compiler warnings as errors" OFF)
mark_as_advanced(MCOR_WERROR)

function (mcor_set_warnings target)
  if (NOT MSVC)
    target_compile_options("${target}" PRIVATE
      -Wall -Wextra -Wshadow -Wconversion $<$<BOOL:${MCOR_WERROR}>:-Werror>)
  endif ()
endfunction ()
