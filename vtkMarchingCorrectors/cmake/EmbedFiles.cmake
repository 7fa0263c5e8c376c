# Writes OUTPUT, a C file that defines mcor_kernel_sources (mcor_program.h): the text of all OpenCL sources of
# FOLDER/kernels/programs.cmake, and the programs that they are part of. Run with -P.
include("${FOLDER}/kernels/programs.cmake")
set(code "/* Made by EmbedFiles.cmake. */\n#include \"mcor_program.h\"\n")
set(table "")
foreach (row IN LISTS mcor_program_sources)
  separate_arguments(row UNIX_COMMAND "${row}") # leaves no empty words, as of columns
  list(POP_FRONT row file)
  get_filename_component(name "${file}" NAME)
  string(MAKE_C_IDENTIFIER "${name}" identifier)
  file(READ "${FOLDER}/${file}" bytes HEX)
  # Character constants, unlike numbers, have the right sign for bytes above 127.
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${bytes}")
  string(REGEX REPLACE "('\\\\x0a',)" "\\1\n" bytes "${bytes}")
  string(APPEND code "static const char ${identifier}[] = {\n${bytes}0\n};\n")
  set(form MCOR_ANY_FORM)
  set(programs 0)
  foreach (word IN LISTS row)
    if (word STREQUAL "lanes")
      set(form MCOR_CPU_FORM)
    elseif (word STREQUAL "point")
      set(form MCOR_GPU_FORM)
    else ()
      string(APPEND programs " | 1 << MCOR_PROGRAM_${word}")
    endif ()
  endforeach ()
  string(APPEND table "  { ${identifier}, ${programs}, ${form} },\n")
endforeach ()
file(WRITE "${OUTPUT}" "${code}const mcor_kernel_source mcor_kernel_sources[] = {
${table}  { 0, 0, MCOR_ANY_FORM } };
")
