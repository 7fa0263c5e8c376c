# Finds plain VTK, or ParaView and the VTK inside it. Sets MCOR_VTK_PACKAGE (VTK or ParaView) and MCOR_WRAP_PYTHON, and
# offers MCOR_BUILD_PLUGIN, which is on if ParaView is found, unless it was turned off. On Debian only one of the two
# SDKs can be installed; a build folder serves the SDK for which it was made.
#
# Components are named, because a bare find_package(VTK) asks for every optional dependency of VTK.
set(mcor_vtk_components CommonCore CommonDataModel CommonExecutionModel CommonMisc ParallelCore)
set(mcor_vtk_optional WrappingPythonCore Python FiltersCore FiltersSources IOXML IOXMLParser IOLegacy IOImage
  IOGeometry IOPLY IOHDF hdf5 RenderingAnnotation RenderingCore RenderingFreeType RenderingOpenGL2 TestingRendering ParallelMPI ParallelDIY IOParallelXML)

# VTK 9.3 passes empty arguments on. Without this policy CMake 3.31 warns of that.
set(CMAKE_POLICY_DEFAULT_CMP0174 NEW)

set(mcor_hint "")
if (DEFINED MCOR_SDK)
  string(CONCAT mcor_hint " This build folder was made for ${MCOR_SDK}. If that is no longer the one to "
    "use, take another folder, or start this one anew with cmake --fresh and the same options.")
endif ()
# Debian 13's ParaView names files that are not there; the error that follows does not say so clearly.
if (NOT MCOR_BUILD_PLUGIN STREQUAL "OFF" AND UNIX)
  execute_process(COMMAND "${PROJECT_SOURCE_DIR}/.ci/mend-paraview-sdk" --needed
    RESULT_VARIABLE mcor_mended OUTPUT_QUIET ERROR_QUIET)
  if (mcor_mended EQUAL 0)
    message(WARNING "Debian's ParaView SDK is packaged with files missing. If CMake stops with an error "
      "in ParaView's files, run this as root: ${PROJECT_SOURCE_DIR}/.ci/mend-paraview-sdk")
  endif ()
endif ()

macro(mcor_find_paraview)
  find_package(ParaView QUIET)
  if (ParaView_FOUND AND ParaView_VERSION VERSION_LESS 5.11)
    set(ParaView_FOUND FALSE)
    set(ParaView_NOT_FOUND_MESSAGE "its version is ${ParaView_VERSION}; 5.11 is the first that will do")
  endif ()
  if (ParaView_FOUND)
    set(MCOR_VTK_PACKAGE ParaView)
  elseif (ParaView_CONSIDERED_CONFIGS)
    message(WARNING "There is a ParaView, but it cannot be used: ${ParaView_NOT_FOUND_MESSAGE}")
  endif ()
endmacro()

set(MCOR_VTK_PACKAGE "")
if (MCOR_BUILD_PLUGIN OR NOT DEFINED MCOR_BUILD_PLUGIN)
  mcor_find_paraview()
  if (MCOR_BUILD_PLUGIN AND NOT MCOR_VTK_PACKAGE)
    message(FATAL_ERROR "The plugin (MCOR_BUILD_PLUGIN) needs ParaView >= 5.11, which was not found. "
      "Set ParaView_DIR, or turn MCOR_BUILD_PLUGIN off.${mcor_hint}")
  endif ()
endif ()
if (NOT MCOR_VTK_PACKAGE)
  find_package(VTK 9.1 QUIET COMPONENTS ${mcor_vtk_components}
    OPTIONAL_COMPONENTS ${mcor_vtk_optional})
  if (VTK_FOUND)
    set(MCOR_VTK_PACKAGE VTK)
  elseif (DEFINED MCOR_BUILD_PLUGIN)
    mcor_find_paraview() # for the VTK inside it
  endif ()
endif ()
if (NOT MCOR_VTK_PACKAGE)
  message(FATAL_ERROR "Neither VTK >= 9.1 nor ParaView >= 5.11 was found (Debian: libvtk9-dev, or "
    "paraview-dev). Set VTK_DIR or ParaView_DIR, or build the core alone with -DMCOR_BUILD_VTK=OFF."
    "${mcor_hint}")
endif ()
string(REGEX REPLACE "^([0-9]+[.][0-9]+).*" "\\1" mcor_sdk "${${MCOR_VTK_PACKAGE}_VERSION}")
set(mcor_sdk "${MCOR_VTK_PACKAGE} ${mcor_sdk}")
if (DEFINED MCOR_SDK AND NOT MCOR_SDK STREQUAL mcor_sdk)
  message(FATAL_ERROR "${mcor_sdk} was found.${mcor_hint}")
endif ()
set(MCOR_SDK "${mcor_sdk}" CACHE INTERNAL "What this build folder is made for")
# The option is set only now, because a run that failed must not decide for the next one.
option(MCOR_BUILD_PLUGIN "Build the ParaView plugin" "${ParaView_FOUND}")
message(STATUS "Building for ${MCOR_VTK_PACKAGE} ${${MCOR_VTK_PACKAGE}_VERSION}")

# The tests need the interpreter for which VTK was built; the first python3 on the PATH may be another.
set(mcor_can_wrap OFF)
if (TARGET VTK::WrappingPythonCore AND TARGET VTK::Python)
  set(mcor_can_wrap ON)
  find_package(Python3 QUIET COMPONENTS Interpreter Development.Module)
  find_program(mcor_pvpython pvpython)
  mark_as_advanced(mcor_pvpython)
  foreach (python IN ITEMS "${Python3_EXECUTABLE}" /usr/bin/python3 "${mcor_pvpython}")
    if (NOT MCOR_VTK_PYTHON AND EXISTS "${python}")
      execute_process(COMMAND "${python}" -c "import vtkmodules.vtkCommonExecutionModel"
        RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
      if (NOT failed)
        set(MCOR_VTK_PYTHON "${python}" CACHE FILEPATH "An interpreter that has VTK's modules")
      endif ()
    endif ()
  endforeach ()
endif ()
option(MCOR_WRAP_PYTHON "Make the filter usable from Python" ${mcor_can_wrap})

# If VTK was built with MPI, many processes can share a surface.
set(mcor_can_share OFF)
if (TARGET VTK::ParallelMPI AND TARGET VTK::ParallelDIY)
  set(mcor_can_share ON)
endif ()
option(MCOR_USE_MPI "Let MPI's processes share a surface; needs VTK with MPI and DIY" ${mcor_can_share})
set(MCOR_HAS_RANKS OFF)
if (MCOR_USE_MPI AND mcor_can_share)
  set(MCOR_HAS_RANKS ON)
elseif (MCOR_USE_MPI)
  message(FATAL_ERROR "MCOR_USE_MPI needs a VTK that was built with MPI and DIY (modules ParallelMPI and "
    "ParallelDIY). Turn it off, or use another VTK.${mcor_hint}")
endif ()
