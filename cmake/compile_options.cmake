# One binary gives the same bits on every x86-64-v2 or later processor (design: deterministic), hence no contraction and no
# -march=native. errno and trapping arithmetic are not used; dropping them changes no result and lets sqrt vectorise.
add_library(meshfront_options INTERFACE)
target_compile_options(meshfront_options INTERFACE
  -Wall -Wextra -Wno-missing-field-initializers -ffp-contract=off -fno-math-errno -fno-trapping-math)
target_include_directories(meshfront_options INTERFACE $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}>)
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  target_compile_options(meshfront_options INTERFACE -march=x86-64-v2)
endif()
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  string(REPLACE "-O3" "-O2" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")
  target_compile_options(meshfront_options INTERFACE $<$<CONFIG:Release>:-O3>)
endif()
if(MESHFRONT_SANITIZE)
  target_compile_options(meshfront_options INTERFACE -fsanitize=${MESHFRONT_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=all -O1 -g1)
  target_compile_definitions(meshfront_options INTERFACE MESHFRONT_SANITIZED)  # tests take smaller shapes
  # Protobuf's headers lay out maps differently where they see this, but Debian's library, and what protoc makes, do not.
  target_compile_options(meshfront_options INTERFACE -U__SANITIZE_THREAD__)
  target_link_options(meshfront_options INTERFACE -fsanitize=${MESHFRONT_SANITIZE})
endif()
# meshfront_precompile(TARGET header...): parses what most of a target's files include once, which takes a fifth off the
# sanitizers' and the debug builds. Not in the release build: there a file that leans on another's #include must fail.
option(MESHFRONT_PRECOMPILE "Precompile the headers that most files include" OFF)
function(meshfront_precompile target)
  if(MESHFRONT_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()
# Linked last by tests: UBSan doubles the time that they take to compile, and they are not what is under test.
add_library(meshfront_test_options INTERFACE)
if(MESHFRONT_SANITIZE MATCHES undefined)
  target_compile_options(meshfront_test_options INTERFACE -fno-sanitize=undefined)
endif()
