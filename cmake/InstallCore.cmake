# Installs the core: the library, its headers and mcor.pc. Included by the top level, after the core. The installed
# library is shared if the build's libraries are; the tests and filters here call the static one.
find_package(Threads REQUIRED)
set(mcor_installed mcor)
if (BUILD_SHARED_LIBS AND NOT MCOR_BUILD_PYTHON_WHEEL)
  set(mcor_installed mcor_shared)
  set_source_files_properties(${mcor_ahead_objects} PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)
  add_library(mcor_shared SHARED $<TARGET_OBJECTS:mcor> ${mcor_ahead_objects})
  add_dependencies(mcor_shared mcor) # mcor makes the kernels' objects
  set_target_properties(mcor_shared PROPERTIES
    OUTPUT_NAME     mcor
    EXPORT_NAME     mcor
    LINKER_LANGUAGE C
    VERSION         "${PROJECT_VERSION}"
    SOVERSION       "${PROJECT_VERSION_MAJOR}")
  target_include_directories(mcor_shared INTERFACE "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
  target_link_libraries(mcor_shared PRIVATE Threads::Threads $<$<BOOL:${UNIX}>:m> ${CMAKE_DL_LIBS})
endif ()
install(TARGETS ${mcor_installed} EXPORT mcor
  ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
  LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
  RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
# mcor.pc is for users without CMake. It has a relative path, so the installed tree may be moved.
file(RELATIVE_PATH mcor_pc_prefix "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
string(REGEX REPLACE "/$" "" mcor_pc_prefix "${mcor_pc_prefix}")
if (UNIX)
  set(mcor_pc_libs "-Wl,-rpath,\${libdir}")
  if (mcor_installed STREQUAL mcor)
    set(mcor_pc_libs "-pthread -lm")
    foreach (library IN LISTS CMAKE_DL_LIBS)
      string(APPEND mcor_pc_libs " -l${library}")
    endforeach ()
  endif ()
  configure_file("${PROJECT_SOURCE_DIR}/cmake/mcor.pc.in" "${CMAKE_BINARY_DIR}/mcor.pc" @ONLY)
  install(FILES "${CMAKE_BINARY_DIR}/mcor.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
endif ()
install(FILES vtkMarchingCorrectors/core/mcor.h vtkMarchingCorrectors/core/mcor_parts.h
  vtkMarchingCorrectors/core/mcor_find.h vtkMarchingCorrectors/core/mcor_says.def DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
