# Writes OUTPUT from INPUT with the version and the commit of SOURCE_DIR; touches OUTPUT only when they changed. Run at
# every build (cmake -P), so that a new commit shows without configuring again. Outside a git work tree of our own
# (a tarball, even one unpacked inside another repository) the commit is "unknown".
#
# Variables: INPUT, OUTPUT, SOURCE_DIR, RICCI_VERSION.
set(RICCI_GIT "unknown")
find_program(GIT_PROGRAM git)
if(GIT_PROGRAM AND EXISTS "${SOURCE_DIR}/.git")
    execute_process(
        COMMAND "${GIT_PROGRAM}" -c "safe.directory=${SOURCE_DIR}" describe --always --abbrev=40 --dirty --exclude *
        WORKING_DIRECTORY "${SOURCE_DIR}" OUTPUT_VARIABLE described ERROR_QUIET RESULT_VARIABLE result
        OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(result EQUAL 0 AND described MATCHES "^[0-9a-f]+(-dirty)?$")
        set(RICCI_GIT "${described}")
    endif()
endif()
configure_file("${INPUT}" "${OUTPUT}" @ONLY)
