# Each header alone: it is included twice and nothing else is, so a missing include or a missing
# guard is a compile error.
file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}/include"
  "${PROJECT_SOURCE_DIR}/include/slamgc/*.hpp")
set(alone "")
foreach(header IN LISTS headers)
  string(REGEX REPLACE "\\.hpp$" ".cpp" source "${CMAKE_CURRENT_BINARY_DIR}/alone/${header}")
  set(text "#include <${header}>\n#include <${header}>\n")
  set(old "")
  if(EXISTS "${source}")
    file(READ "${source}" old)
  endif()
  if(NOT old STREQUAL text)
    file(WRITE "${source}" "${text}")
  endif()
  list(APPEND alone "${source}")
endforeach()

if("headers" IN_LIST SLAMGC_TEST_PARTS)
  foreach(standard IN LISTS SLAMGC_HEADER_STANDARDS)
    add_library(slamgc_headers_${standard} OBJECT ${alone})
    target_link_libraries(slamgc_headers_${standard} PRIVATE slamgc_own)
    target_include_directories(slamgc_headers_${standard} PRIVATE support/fake_tracy)
    set_target_properties(slamgc_headers_${standard} PROPERTIES CXX_STANDARD ${standard})
  endforeach()

  # What a user pays for the umbrella header in every file, as a number that does not depend on
  # the machine. Raise the limit knowingly.
  set(SLAMGC_UMBRELLA_LINES 50000 CACHE STRING
    "Most lines the umbrella header may have after preprocessing")
  add_test(NAME headers.umbrella_lines
    COMMAND "${PROJECT_SOURCE_DIR}/scripts/measure_compile_time"
      --compiler "${CMAKE_CXX_COMPILER}" --max-lines ${SLAMGC_UMBRELLA_LINES})
  set_tests_properties(headers.umbrella_lines PROPERTIES LABELS headers TIMEOUT 60)
endif()

if("no_exceptions" IN_LIST SLAMGC_TEST_PARTS)
  add_library(slamgc_headers_no_exceptions OBJECT ${alone})
  add_executable(no_exceptions_consumer consumer/consumer.cpp)
  add_executable(no_exceptions_program support/no_exceptions_program.cpp)
  list(GET SLAMGC_HEADER_STANDARDS -1 newest)
  set_target_properties(slamgc_headers_no_exceptions PROPERTIES CXX_STANDARD ${newest})
  target_include_directories(slamgc_headers_no_exceptions PRIVATE support/fake_tracy)
  target_include_directories(no_exceptions_program PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}")
  foreach(target IN ITEMS slamgc_headers_no_exceptions no_exceptions_consumer no_exceptions_program)
    target_link_libraries(${target} PRIVATE slamgc_own)
    target_compile_options(${target} PRIVATE -fno-exceptions -fno-rtti)
  endforeach()
  add_test(NAME no_exceptions.consumer COMMAND no_exceptions_consumer)
  add_test(NAME no_exceptions.program COMMAND no_exceptions_program)
  set_tests_properties(no_exceptions.consumer no_exceptions.program PROPERTIES LABELS headers TIMEOUT 60)
endif()
