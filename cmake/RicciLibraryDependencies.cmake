# What the three libraries need: used by this project's own build and, installed, by find_package(ricci). Debian
# packages only; docs/dependencies.md says which, under what licence, and why.
#
# The includer defines ricci_find(...), which is find_package or find_dependency, and RICCI_CHOLMOD. The interface
# targets are imported ones, so that the exported libraries refer to them by name and the consumer's own machine
# says where things lie.
ricci_find(Eigen3 3.4 NO_MODULE)
ricci_find(TBB)
ricci_find(ZLIB)
ricci_find(OpenMesh CONFIG)
ricci_find(nanoflann)
ricci_find(nlohmann_json)
ricci_find(fmt)
find_path(HDF5_INCLUDE_DIR hdf5.h PATH_SUFFIXES hdf5/serial REQUIRED)
find_library(HDF5_C_LIBRARY NAMES hdf5_serial hdf5 PATH_SUFFIXES hdf5/serial REQUIRED)
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
find_library(XXHASH_LIBRARY xxhash REQUIRED)
find_path(BOOST_MULTIPRECISION_INCLUDE_DIR boost/multiprecision/mpfr.hpp REQUIRED)
find_path(MPFR_INCLUDE_DIR mpfr.h REQUIRED)
find_library(MPFR_LIBRARY mpfr REQUIRED)
find_library(GMP_LIBRARY gmp REQUIRED)

add_library(ricci_io_dependencies INTERFACE IMPORTED)
target_include_directories(ricci_io_dependencies SYSTEM INTERFACE ${HDF5_INCLUDE_DIR} ${XXHASH_INCLUDE_DIR})
target_link_libraries(ricci_io_dependencies INTERFACE
    ${HDF5_C_LIBRARY} ZLIB::ZLIB ${XXHASH_LIBRARY} fmt::fmt nlohmann_json::nlohmann_json)

add_library(ricci_kernels_dependencies INTERFACE IMPORTED)
target_include_directories(ricci_kernels_dependencies SYSTEM INTERFACE ${BOOST_MULTIPRECISION_INCLUDE_DIR} ${MPFR_INCLUDE_DIR})
target_link_libraries(ricci_kernels_dependencies INTERFACE ${MPFR_LIBRARY} ${GMP_LIBRARY})

add_library(ricci_engine_dependencies INTERFACE IMPORTED)
target_link_libraries(ricci_engine_dependencies INTERFACE
    ricci_kernels_dependencies fmt::fmt OpenMeshCore OpenMeshTools nanoflann::nanoflann)

if(RICCI_CHOLMOD)
    ricci_find(OpenMP COMPONENTS CXX)  # only to keep CHOLMOD's own parallel regions serial
    find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
    find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
    target_include_directories(ricci_engine_dependencies SYSTEM INTERFACE ${CHOLMOD_INCLUDE_DIR})
    target_link_libraries(ricci_engine_dependencies INTERFACE ${CHOLMOD_LIBRARY} OpenMP::OpenMP_CXX)
    target_compile_definitions(ricci_engine_dependencies INTERFACE RICCI_HAS_CHOLMOD=1)
    # CHOLMOD asks for whatever libblas.so.3 the machine prefers. Several workers call it at a time, and Debian's serial
    # OpenBLAS is not safe for that: it hands the same buffer to two callers now and then, which changes bits (see
    # docs/dependencies.md). Linked directly, and found by run path, the pthread flavour is loaded first and wins; the program sets
    # it to one thread. Named twice: plainly for the run path, and in one flag that keeps a linker from dropping what only
    # CHOLMOD calls.
    find_library(RICCI_LAPACK lapack PATH_SUFFIXES openblas-pthread NO_DEFAULT_PATH
        PATHS "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}" /usr/lib64 /usr/lib)
    find_library(RICCI_BLAS blas PATH_SUFFIXES openblas-pthread NO_DEFAULT_PATH
        PATHS "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}" /usr/lib64 /usr/lib)
    if(RICCI_LAPACK MATCHES "pthread" AND RICCI_BLAS MATCHES "pthread")
        target_link_libraries(ricci_engine_dependencies INTERFACE
            ${RICCI_LAPACK} ${RICCI_BLAS}
            "-Wl,--push-state,--no-as-needed,${RICCI_LAPACK},${RICCI_BLAS},--pop-state")
    else()
        message(WARNING "No pthread OpenBLAS (Debian: libopenblas-pthread-dev): CHOLMOD will use the machine's default "
            "BLAS. It must be safe for concurrent callers, and should start no threads of its own.")
    endif()
endif()
