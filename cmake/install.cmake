# SPDX-License-Identifier: Apache-2.0
# `cmake --install`: command, libraries, headers, pkg-config, man page, completions.
install(TARGETS terrazzo LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS terrazzo_static ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(folder base elements curves analysis synthesis)
    file(GLOB headers CONFIGURE_DEPENDS ${folder}/*.h)
    list(FILTER headers EXCLUDE REGEX "_(internal|module)\\.h$")
    install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/terrazzo/${folder})
endforeach()
configure_file(cmake/terrazzo.pc.in terrazzo.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/terrazzo.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(TARGET terrazzo_cli)
    install(TARGETS terrazzo_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
    # The man page comes from the parameter tables, by way of the command itself.
    install(CODE "
        execute_process(COMMAND \"$<TARGET_FILE:terrazzo_cli>\" params --man
                        OUTPUT_VARIABLE page RESULT_VARIABLE rc ERROR_QUIET)
        if(rc EQUAL 0 AND page)
            file(WRITE \"${CMAKE_BINARY_DIR}/terrazzo.1\" \"\${page}\")
            file(INSTALL \"${CMAKE_BINARY_DIR}/terrazzo.1\"
                 DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1\")
        else()
            message(STATUS \"no man page: the command does not print one yet\")
        endif()")
endif()
set(completions ${PROJECT_SOURCE_DIR}/data/completions)
install(FILES ${completions}/terrazzo.bash OPTIONAL RENAME terrazzo
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${completions}/_terrazzo OPTIONAL
        DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
install(DIRECTORY data/presets OPTIONAL
        DESTINATION ${CMAKE_INSTALL_DATADIR}/terrazzo)
