# Builds the VTK module, its Python package and the ParaView plugin. Included by the top level.
include("${CMAKE_CURRENT_LIST_DIR}/FindVTKOrParaView.cmake")
set(mcor_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/MarchingCorrectors")

vtk_module_scan(
  MODULE_FILES     "${PROJECT_SOURCE_DIR}/vtkMarchingCorrectors/vtk.module"
  REQUEST_MODULES  VTK::vtkMarchingCorrectors
  PROVIDES_MODULES mcor_modules
  HIDE_MODULES_FROM_CACHE ON)
vtk_module_build(
  MODULES             ${mcor_modules}
  PACKAGE             MarchingCorrectors
  INSTALL_EXPORT      MarchingCorrectors
  TEST_DIRECTORY_NAME NONE # the module's tests are for VTK's own build
  CMAKE_DESTINATION   "${mcor_package_dir}"
  VERSION             "${PROJECT_VERSION}"
  SOVERSION           "${PROJECT_VERSION_MAJOR}")

add_library(MarchingCorrectors::vtkMarchingCorrectors ALIAS vtkMarchingCorrectors)

if (MCOR_WRAP_PYTHON)
  if (NOT DEFINED MCOR_PYTHON_DESTINATION)
    # Debian's interpreter looks for add-on packages in dist-packages, all others in site-packages.
    set(packages site-packages)
    if (EXISTS /etc/debian_version)
      set(packages dist-packages)
    endif ()
    set(MCOR_PYTHON_DESTINATION "lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/${packages}"
      CACHE STRING "Where the Python package is installed, relative to the prefix")
  endif ()
  vtk_module_wrap_python(
    MODULES             ${mcor_modules}
    TARGET              MarchingCorrectors::Python
    PYTHON_PACKAGE      marchingcorrectors
    MODULE_DESTINATION  "${MCOR_PYTHON_DESTINATION}"
    CMAKE_DESTINATION   "${mcor_package_dir}"
    LIBRARY_DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    INSTALL_HEADERS     OFF
    BUILD_STATIC        OFF)
  set(init "${PROJECT_SOURCE_DIR}/vtkMarchingCorrectors/__init__.py")
  configure_file("${init}"
    "${CMAKE_BINARY_DIR}/${MCOR_PYTHON_DESTINATION}/marchingcorrectors/__init__.py" COPYONLY)
  install(FILES "${init}" DESTINATION "${MCOR_PYTHON_DESTINATION}/marchingcorrectors")
endif ()

if (MCOR_BUILD_PLUGIN)
  paraview_plugin_scan(
    PLUGIN_FILES     "${PROJECT_SOURCE_DIR}/Plugin/paraview.plugin"
    PROVIDES_PLUGINS mcor_plugins
    ENABLE_BY_DEFAULT         ON
    HIDE_PLUGINS_FROM_CACHE   ON)
  paraview_plugin_build(
    PLUGINS              ${mcor_plugins}
    LIBRARY_SUBDIRECTORY "${PARAVIEW_PLUGIN_SUBDIR}"
    PLUGINS_FILE_NAME    "marchingcorrectors.plugins.xml"
    AUTOLOAD             ${mcor_plugins})
endif ()
