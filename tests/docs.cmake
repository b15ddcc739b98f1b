# What is checked without running the library: documentation, memory orders, layout of the code.
function(slamgc_docs_test name)
  add_test(NAME docs.${name} COMMAND ${ARGN} WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
  set_tests_properties(docs.${name} PROPERTIES LABELS docs TIMEOUT 120)
endfunction()

slamgc_docs_test(memory_orders Python3::Interpreter scripts/check_memory_orders)
slamgc_docs_test(locks Python3::Interpreter scripts/check_locks)
slamgc_docs_test(readme Python3::Interpreter scripts/check_readme)
slamgc_docs_test(mutants Python3::Interpreter tests/tools/order_mutants --list)

find_program(SLAMGC_DOXYGEN doxygen)
if(SLAMGC_DOXYGEN)
  slamgc_docs_test(doxygen scripts/docs "${CMAKE_CURRENT_BINARY_DIR}/doxygen")
else()
  slamgc_skip(docs.doxygen "doxygen was not found")
endif()

# Another version of clang-format lays code out differently, so it has to be this one. That of
# clang-tidy has other checks.
find_program(SLAMGC_CLANG_FORMAT clang-format-14)
if(SLAMGC_CLANG_FORMAT)
  slamgc_docs_test(format scripts/format --check)
else()
  slamgc_skip(docs.format "clang-format-14 was not found")
endif()

find_program(SLAMGC_SHELLCHECK shellcheck)
if(SLAMGC_SHELLCHECK)
  slamgc_docs_test(shellcheck scripts/check_shell)
else()
  slamgc_skip(docs.shellcheck "shellcheck was not found")
endif()

find_program(SLAMGC_CLANG_TIDY clang-tidy-14)
if(SLAMGC_CLANG_TIDY)
  slamgc_docs_test(tidy "${SLAMGC_CLANG_TIDY}" --quiet include/slamgc/slamgc.hpp
    -- -xc++ -std=c++17 -Iinclude)
else()
  slamgc_skip(docs.tidy "clang-tidy-14 was not found")
endif()
