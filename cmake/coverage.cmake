# The target slamgc_coverage: what the tests that ran so far have covered of the headers.
set(SLAMGC_COVERAGE_FLOOR 95 CACHE STRING "Least line coverage of include/slamgc, in percent")
find_program(SLAMGC_GCOVR gcovr REQUIRED)
string(REGEX REPLACE "g\\+\\+(-[0-9]+)?$" "gcov\\1" gcov "${CMAKE_CXX_COMPILER}")
add_custom_target(slamgc_coverage
  COMMAND "${SLAMGC_GCOVR}" --root "${PROJECT_SOURCE_DIR}" --filter "${PROJECT_SOURCE_DIR}/include/"
    --gcov-executable "${gcov}" --exclude-throw-branches
    --fail-under-line ${SLAMGC_COVERAGE_FLOOR} "${PROJECT_BINARY_DIR}"
  COMMENT "Line coverage, at least ${SLAMGC_COVERAGE_FLOOR} %"
  WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}" USES_TERMINAL VERBATIM)
