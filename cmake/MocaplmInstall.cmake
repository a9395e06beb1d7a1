# cmake --install: the program, manual page, completions, settings files and documents, and a package with which another C++ program links
# the directories that read, write and generate motion without LibTorch:
#   find_package(mocaplm REQUIRED)
#   target_link_libraries(mine PRIVATE mocaplm::generate)
include(CMakePackageConfigHelpers)

install(TARGETS mocaplm mocaplm-scene mocaplm-torch RUNTIME COMPONENT program)
set(made ${CMAKE_BINARY_DIR}/app)
install(FILES ${made}/mocaplm.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
install(FILES ${made}/mocaplm.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME mocaplm
        COMPONENT program)
install(FILES ${made}/_mocaplm DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT program)
install(DIRECTORY configs DESTINATION ${CMAKE_INSTALL_DATADIR}/mocaplm COMPONENT program)
# Where the README's links find them.
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program FILES_MATCHING PATTERN "*.md")
install(FILES README.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)

set(package_libraries common numeric motion tokenizer model generate)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/mocaplm)
foreach(name ${package_libraries})
  set_target_properties(mocaplm_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS mocaplm_${name} EXPORT mocaplmTargets ARCHIVE COMPONENT development)
  install(DIRECTORY ${name} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mocaplm COMPONENT development
          FILES_MATCHING PATTERN "*.h" PATTERN "transformer" EXCLUDE)
endforeach()
install(EXPORT mocaplmTargets NAMESPACE mocaplm:: DESTINATION ${package_folder} COMPONENT development)
configure_package_config_file(cmake/mocaplmConfig.cmake.in ${CMAKE_BINARY_DIR}/mocaplmConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/mocaplmConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/mocaplmConfig.cmake ${CMAKE_BINARY_DIR}/mocaplmConfigVersion.cmake
        DESTINATION ${package_folder} COMPONENT development)

# cpack -G DEB: one package with everything. What it needs is read from the programs themselves.
set(CPACK_PACKAGE_VENDOR "mocaplm")
set(CPACK_PACKAGE_CONTACT "mocaplm developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "learns motion capture as a language, and dances on")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_STRIP_FILES ON)
include(CPack)
