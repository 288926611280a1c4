# Everything this project's build needs: the libraries' dependencies, and the command line's.
macro(ricci_find)
    find_package(${ARGN} REQUIRED)
endmacro()
include(cmake/RicciLibraryDependencies.cmake)
ricci_find(CLI11)
ricci_find(tomlplusplus)
ricci_find(spdlog)
ricci_find(Threads)

add_library(ricci_app_dependencies INTERFACE)
target_link_libraries(ricci_app_dependencies INTERFACE
    CLI11::CLI11 tomlplusplus::tomlplusplus nlohmann_json::nlohmann_json spdlog::spdlog fmt::fmt Threads::Threads)
