# Compiler options shared by every target of this project (never exported to users).
include(GNUInstallDirs)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
find_program(RICCI_CCACHE ccache)
if(RICCI_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER "${RICCI_CCACHE}")
endif()
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

add_library(ricci_options INTERFACE)
target_compile_features(ricci_options INTERFACE cxx_std_20)
target_compile_options(ricci_options INTERFACE
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    # GCC 12 raises it falsely inside std::string (GCC bug 105651).
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
    # Same bits from every translation unit: no fused multiply-add behind our back.
    -ffp-contract=off -fopenmp-simd -fno-math-errno -fno-trapping-math)
if(RICCI_WERROR)
    target_compile_options(ricci_options INTERFACE -Werror)
endif()
if(RICCI_SANITIZE)
    target_compile_options(ricci_options INTERFACE -fsanitize=${RICCI_SANITIZE} -fno-omit-frame-pointer
        -fno-sanitize-recover=all
        # Instrumented code makes GCC's flow analysis see uninitialised values that are none (in OpenMesh, for one).
        $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    target_link_options(ricci_options INTERFACE -fsanitize=${RICCI_SANITIZE})
    # A sanitizer's runtime is not up yet when ifunc resolvers run.
    target_compile_definitions(ricci_options INTERFACE RICCI_NO_CLONES)
    if(RICCI_SANITIZE MATCHES thread)
        target_compile_definitions(ricci_options INTERFACE RICCI_PLAIN_THREADS)
    endif()
endif()

if(RICCI_FUZZ)
    if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
        message(FATAL_ERROR "RICCI_FUZZ needs clang and its libFuzzer (Debian: clang-14, libclang-rt-14-dev): use the preset fuzz")
    endif()
    # Every room counts its branches; the targets of tests/fuzz link the engine that reads the counts.
    # Instrumented loops do not vectorise, which is no fault here.
    target_compile_options(ricci_options INTERFACE -fsanitize=fuzzer-no-link -Wno-pass-failed)
    target_link_options(ricci_options INTERFACE -fsanitize=fuzzer-no-link)
endif()

# For what glues rooms together and what tests them: halves the time that the compiler takes. All that computes is in
# kernels and engine; the same bits at any level, since nothing here relaxes floating-point arithmetic.
function(ricci_compile_quickly target)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

function(ricci_add_room name sources)
    add_library(ricci_${name} STATIC ${sources})
    add_library(ricci::${name} ALIAS ricci_${name})
    set_target_properties(ricci_${name} PROPERTIES EXPORT_NAME ${name})
    target_compile_features(ricci_${name} PUBLIC cxx_std_20)
    target_link_libraries(ricci_${name} PRIVATE $<BUILD_INTERFACE:ricci_options>)
    target_include_directories(ricci_${name} PUBLIC
        $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/ricci>)
endfunction()
