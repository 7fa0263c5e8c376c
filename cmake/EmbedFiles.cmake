# Writes OUTPUT, a C file that defines for each of FILES a NUL-terminated character array:
# mcor_prelude.cl becomes mcor_source_mcor_prelude_cl. Run with cmake -DOUTPUT=... -DFILES=... -P.
set(code "/* Made by EmbedFiles.cmake. */\n")
foreach (file IN LISTS FILES)
  get_filename_component(name "${file}" NAME)
  string(MAKE_C_IDENTIFIER "mcor_source_${name}" identifier)
  file(READ "${file}" bytes HEX)
  # Character constants, unlike numbers, have the right sign for bytes above 127.
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${bytes}")
  string(REGEX REPLACE "('\\\\x0a',)" "\\1\n" bytes "${bytes}")
  string(APPEND code "extern const char ${identifier}[];\nconst char ${identifier}[] = {\n${bytes}0\n};\n")
endforeach ()
file(WRITE "${OUTPUT}" "${code}")
