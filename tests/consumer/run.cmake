# cmake -DWAY=... -P run.cmake: one way to consume slamgc, see CMakeLists.txt.
cmake_minimum_required(VERSION 3.16)

set(prefix "${WORK}/prefix")
set(work "${WORK}/${WAY}")
set(consumer "${SOURCE}/tests/consumer")
file(REMOVE_RECURSE "${work}")
file(MAKE_DIRECTORY "${work}")

function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY "${work}" RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    string(REPLACE ";" " " command "${ARGV}")
    message(FATAL_ERROR "failed (${result}): ${command}")
  endif()
endfunction()

# Configures, builds and runs a CMake project.
function(run_project source)
  run("${CMAKE_COMMAND}" -S "${source}" -B "${work}/build" -G "${GENERATOR}"
    "-DCMAKE_CXX_COMPILER=${COMPILER}" -DCMAKE_BUILD_TYPE=Release ${ARGN})
  run("${CMAKE_COMMAND}" --build "${work}/build")
  run("${work}/build/consumer")
endfunction()

if(WAY STREQUAL "install")
  # Installed in one place and moved to another: nothing in it may name where it was.
  run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${work}/here")
  file(REMOVE_RECURSE "${prefix}")
  file(RENAME "${work}/here" "${prefix}")
elseif(WAY STREQUAL "find_package")
  run_project("${consumer}/find_package" "-DCMAKE_PREFIX_PATH=${prefix}"
    -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF "-Dexpected_version=${VERSION}")
elseif(WAY STREQUAL "add_subdirectory")
  run_project("${consumer}/add_subdirectory" "-Dslamgc_source=${SOURCE}")
elseif(WAY STREQUAL "pkg_config")
  set(ENV{PKG_CONFIG_PATH} "${prefix}/share/pkgconfig")
  run(pkg-config --exists --print-errors "slamgc = ${VERSION}")
  execute_process(COMMAND pkg-config --cflags --libs slamgc OUTPUT_VARIABLE flags)
  separate_arguments(flags UNIX_COMMAND "${flags}")
  run("${COMPILER}" -std=c++17 "${consumer}/consumer.cpp" -o consumer ${flags})
  run("${work}/consumer")
elseif(WAY STREQUAL "copied_folder")
  file(COPY "${SOURCE}/include/slamgc" DESTINATION "${work}/third_party")
  run("${COMPILER}" -std=c++17 -pthread -Ithird_party "${consumer}/consumer.cpp" -o consumer)
  run("${work}/consumer")
else()
  message(FATAL_ERROR "there is no way '${WAY}'")
endif()
