# SPDX-License-Identifier: Apache-2.0
# `cmake --install`: command, libraries, headers, pkg-config, man page, completions.
install(TARGETS terrazzo LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS terrazzo_static ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(folder base elements fields curves scenes analysis synthesis)
    file(GLOB headers CONFIGURE_DEPENDS ${folder}/*.h)
    list(FILTER headers EXCLUDE REGEX "_(internal|module)\\.h$")
    install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/terrazzo/${folder})
endforeach()
# relative to the file itself, so that `cmake --install --prefix` and DESTDIR hold
file(RELATIVE_PATH TZ_PC_PREFIX /p/${CMAKE_INSTALL_LIBDIR}/pkgconfig /p)
configure_file(cmake/terrazzo.pc.in terrazzo.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/terrazzo.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(TARGET terrazzo_cli)
    install(TARGETS terrazzo_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
    # Man page and completions come from the parameter tables, by way of the command.
    foreach(text "man;terrazzo.1;${CMAKE_INSTALL_MANDIR}/man1"
            "bash;terrazzo;${CMAKE_INSTALL_DATADIR}/bash-completion/completions"
            "zsh;_terrazzo;${CMAKE_INSTALL_DATADIR}/zsh/site-functions")
        list(GET text 0 format)
        list(GET text 1 file)
        list(GET text 2 folder)
        install(CODE "
            file(MAKE_DIRECTORY \"${CMAKE_BINARY_DIR}/texts\")
            execute_process(COMMAND \"$<TARGET_FILE:terrazzo_cli>\" params --format ${format}
                            OUTPUT_FILE \"${CMAKE_BINARY_DIR}/texts/${file}\"
                            COMMAND_ERROR_IS_FATAL ANY)
            file(INSTALL \"${CMAKE_BINARY_DIR}/texts/${file}\"
                 DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${folder}\")")
    endforeach()
endif()
install(DIRECTORY data/presets OPTIONAL
        DESTINATION ${CMAKE_INSTALL_DATADIR}/terrazzo)
install(FILES data/edge-forest.yml.gz OPTIONAL
        DESTINATION ${CMAKE_INSTALL_DATADIR}/terrazzo)
