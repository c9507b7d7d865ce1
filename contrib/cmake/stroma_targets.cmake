# How Stroma's targets are compiled. deal_ii_initialize_cached_variables() empties the optimisation flags, and
# deal_ii_setup_target() puts them back: targets without deal.II set their own.

function(stroma_options target)
  target_compile_options(${target} PRIVATE -Wall -Wextra)
  if(CMAKE_COMPILE_WARNING_AS_ERROR) # but not what the optimiser guesses, which depends on the processor
    target_compile_options(${target} PRIVATE -Wno-error=maybe-uninitialized -Wno-error=array-bounds -Wno-error=stringop-overflow)
  endif()
  if(STROMA_NATIVE)
    target_compile_options(${target} PRIVATE -march=native)
  endif()
  if(STROMA_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=address,undefined -fno-omit-frame-pointer)
    target_link_options(${target} PRIVATE -fsanitize=address,undefined)
  endif()
endfunction()

# A target that uses deal.II.
function(stroma_target target)
  deal_ii_setup_target(${target})
  target_include_directories(${target} SYSTEM PRIVATE ${EIGEN3_INCLUDE_DIRS})
  target_compile_definitions(${target} PRIVATE EIGEN_DONT_VECTORIZE) # no kernel needs it, and its sums would depend on where in memory numbers stand
  stroma_options(${target})
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(${target} PRIVATE -O3 -g0) # deal.II's own flags ask for debug information
  endif()
endfunction()

# deal.II's headers take half of the time of a compilation: they are read once for all sources of a target.
function(stroma_precompile target)
  target_precompile_headers(${target} PRIVATE ${PROJECT_SOURCE_DIR}/contrib/cmake/precompiled.h)
  target_compile_options(${target} PRIVATE -fpch-preprocess) # for ccache
endfunction()

# deal.II's headers and templates take most of the time of a compilation: with STROMA_UNITY the files of a room are compiled
# together, at most a dozen at once. A class whose members stand in several files is instantiated in each, and so its
# *_output, *_state, *_view, *_checkpoint and *_supports go with those of other classes.
function(stroma_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${STROMA_UNITY} UNITY_BUILD_MODE GROUP)
  if(STROMA_UNITY)
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage) # GCC takes the included sources for headers
  endif()
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cc$")
  foreach(source ${sources})
    get_filename_component(group ${source} DIRECTORY)
    get_filename_component(group ${group} NAME)
    if(source MATCHES "[_/](output|state|view|checkpoint|supports)\\.cc$")
      set(group with_${CMAKE_MATCH_1})
    endif()
    math(EXPR n_${group} "0${n_${group}} + 1")
    math(EXPR part "(${n_${group}} - 1) / 12")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group}_${part})
  endforeach()
endfunction()

# The shared library of everything but images.
function(stroma_library target)
  add_library(${target} SHARED ${ARGN})
  set_target_properties(${target} PROPERTIES OUTPUT_NAME stroma EXPORT_NAME stroma)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_definitions(${target} PUBLIC STROMA_VERSION="${PROJECT_VERSION}")
  stroma_target(${target})
  stroma_precompile(${target})
  stroma_unity(${target})
endfunction()

# The image room: ITK inside, plain C++ outside.
function(stroma_image_library target)
  find_package(TIFF REQUIRED)
  find_package(ZLIB REQUIRED)
  file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/source/image/*.cc)
  if(STROMA_ITK)
    # ITK's configuration looks at GDCM whatever is asked for, and GDCM's tells at length that Debian packs its programs apart.
    # Both are status messages: warnings and errors are still told.
    set(CMAKE_MESSAGE_LOG_LEVEL NOTICE)
    find_package(ITK 5 REQUIRED COMPONENTS ITKCommon ITKIOImageBase ITKIOTIFF ITKIONRRD ITKNrrdIO ITKIOMeta
      ITKMathematicalMorphology ITKSmoothing ITKThresholding ITKConnectedComponents ITKBinaryMathematicalMorphology
      ITKDistanceMap)
    unset(CMAKE_MESSAGE_LOG_LEVEL)
    list(FILTER sources EXCLUDE REGEX "without_itk.cc$")
  else()
    list(FILTER sources EXCLUDE REGEX "/(automatic_threshold|hysteresis|itk_io|nrrd|phantom|pieces|smooth|thickness|write).cc$")
  endif()
  add_library(${target} SHARED ${sources})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_include_directories(${target} SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
  target_link_libraries(${target} PRIVATE ${ITK_LIBRARIES} TIFF::TIFF ZLIB::ZLIB)
  target_compile_options(${target} PRIVATE -O2)
  stroma_options(${target})
  stroma_unity(${target})
endfunction()
