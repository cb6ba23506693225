# What is installed besides the program and its libraries, and the packages that cpack makes of it.
add_custom_command(OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/manuals/completion/_rigfit
  COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/packaging/manuals.sh $<TARGET_FILE:rigfit> ${CMAKE_CURRENT_BINARY_DIR}/manuals
  DEPENDS rigfit packaging/manuals.sh VERBATIM)
add_custom_target(manuals DEPENDS ${CMAKE_CURRENT_BINARY_DIR}/manuals/completion/_rigfit)
install(DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/manuals/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 OPTIONAL)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/manuals/completion/rigfit
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions OPTIONAL)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/manuals/completion/_rigfit
        DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions OPTIONAL)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/rigfit RENAME copyright)
install(FILES ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/rigfit)
install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/rigfit
        PATTERN "CMakeLists.txt" EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/testdata/jalali2021 DESTINATION ${CMAKE_INSTALL_DATADIR}/rigfit/testdata)

set(CPACK_PACKAGE_NAME rigfit)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGE_CONTACT "The rigfit authors <rigfit@localhost>")
set(CPACK_GENERATOR "DEB;TGZ")
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# What compiling against the installed libraries needs.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "cmake, pkg-config, libeigen3-dev, libceres-dev, libfftw3-dev, libgsl-dev, libsundials-dev, libmatio-dev, libsndfile1-dev, zlib1g-dev, libfmt-dev, libtomlplusplus-dev")
include(CPack)
