option(MESHFRONT_ASSERTIONS "Let core check its invariants in a build type that does without (NDEBUG)" OFF)
# core alone: gRPC's headers must agree about NDEBUG with the library that they belong to.
function(meshfront_check_invariants target)
  if(MESHFRONT_ASSERTIONS)
    target_compile_options(${target} PRIVATE -UNDEBUG)
  endif()
endfunction()

# meshfront_room(NAME DEPENDS room... LINK library...): the object library meshfront_NAME from every .cc in core/NAME.
# A room that holds headers only becomes an interface library. ROOM_CLOSURE of the target lists it and all rooms below it:
# linking an object library brings its own objects only, so an executable names the closure (meshfront_link_rooms).
function(meshfront_room name)
  cmake_parse_arguments(ROOM "" "" "DEPENDS;LINK" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cc)
  set(closure meshfront_${name})
  foreach(room ${ROOM_DEPENDS})
    get_target_property(below meshfront_${room} ROOM_CLOSURE)
    list(APPEND closure ${below})
  endforeach()
  list(REMOVE_DUPLICATES closure)
  list(TRANSFORM ROOM_DEPENDS PREPEND meshfront_)
  if(sources)
    add_library(meshfront_${name} OBJECT ${sources})
    target_link_libraries(meshfront_${name} PUBLIC meshfront_options ${ROOM_DEPENDS} ${ROOM_LINK})
    meshfront_check_invariants(meshfront_${name})
    list(LENGTH sources files)
    if(files GREATER 5)  # else the header takes as long to compile as it saves
      meshfront_precompile(meshfront_${name} <algorithm> <array> <cmath> <functional> <memory> <optional> <string> <vector>
        <absl/container/flat_hash_map.h> <absl/status/statusor.h> <absl/strings/str_cat.h> <absl/types/span.h>)
    endif()
    set_property(GLOBAL APPEND PROPERTY MESHFRONT_ROOM_OBJECTS $<TARGET_OBJECTS:meshfront_${name}>)
  else()
    add_library(meshfront_${name} INTERFACE)
    target_link_libraries(meshfront_${name} INTERFACE meshfront_options ${ROOM_DEPENDS} ${ROOM_LINK})
  endif()
  set_target_properties(meshfront_${name} PROPERTIES ROOM_CLOSURE "${closure}")
endfunction()

# Links an executable with a room and every room below it, and with nothing else of core.
function(meshfront_link_rooms target)
  set(all "")
  foreach(room ${ARGN})
    get_target_property(closure meshfront_${room} ROOM_CLOSURE)
    list(APPEND all ${closure})
  endforeach()
  list(REMOVE_DUPLICATES all)
  target_link_libraries(${target} PRIVATE ${all})
endfunction()
