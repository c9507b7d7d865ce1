# The methods that are built. A method is a word here and its entry, source/<room>/entry.cc.
set(STROMA_ALL_METHODS mpm fem nsph sph)
set(STROMA_METHODS "${STROMA_ALL_METHODS}" CACHE STRING "Methods to build, of ${STROMA_ALL_METHODS}; the first is the default of scenes")
option(STROMA_ITK "Images of formats, and thresholds, that need ITK" ON)

if(NOT STROMA_METHODS)
  message(FATAL_ERROR "STROMA_METHODS is empty; give at least one of ${STROMA_ALL_METHODS}")
endif()
set(STROMA_METHOD_ENTRIES "")
set(STROMA_PARTS "") # what tests may need: the methods, and itk
foreach(method ${STROMA_METHODS})
  if(NOT method IN_LIST STROMA_ALL_METHODS)
    message(FATAL_ERROR "STROMA_METHODS has '${method}', allowed are ${STROMA_ALL_METHODS}")
  endif()
  string(APPEND STROMA_METHOD_ENTRIES "ENTRY(${method}) ")
  list(APPEND STROMA_PARTS ${method})
endforeach()
if(STROMA_ITK)
  list(APPEND STROMA_PARTS itk)
endif()
set_source_files_properties(${PROJECT_SOURCE_DIR}/source/methods/table.cc PROPERTIES COMPILE_DEFINITIONS
  "STROMA_METHODS=${STROMA_METHOD_ENTRIES}")

# Rooms that no method of the build needs. nsph and sph share two.
set(STROMA_ROOMS_LEFT_OUT "")
foreach(room mpm fem)
  if(NOT room IN_LIST STROMA_METHODS)
    list(APPEND STROMA_ROOMS_LEFT_OUT ${room})
  endif()
endforeach()
if(NOT nsph IN_LIST STROMA_METHODS AND NOT sph IN_LIST STROMA_METHODS)
  list(APPEND STROMA_ROOMS_LEFT_OUT particles sph)
endif()

# Sets `result` to those of the parts named that the build has not.
function(stroma_lacks result)
  set(lacking ${ARGN})
  list(REMOVE_ITEM lacking ${STROMA_PARTS} "")
  set(${result} "${lacking}" PARENT_SCOPE)
endfunction()
