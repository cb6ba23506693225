# What is installed besides the program and its libraries, and the packages that cpack makes of it.
add_custom_command(OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/manuals/man/rigfit.1
  COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/packaging/manuals.sh $<TARGET_FILE:rigfit> ${CMAKE_CURRENT_BINARY_DIR}/manuals
  DEPENDS rigfit packaging/manuals.sh VERBATIM)
add_custom_target(manuals DEPENDS ${CMAKE_CURRENT_BINARY_DIR}/manuals/man/rigfit.1)
install(DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/manuals/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 OPTIONAL)
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
# Two packages: rigfit, and python3-rigfit where the Python package is built. An archive holds both.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL Unspecified)
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME rigfit)
# What compiling against the installed libraries needs.
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SUGGESTS "cmake, pkg-config, libeigen3-dev, libceres-dev, libfftw3-dev, libgsl-dev, libsundials-dev, libmatio-dev, libpugixml-dev, libsndfile1-dev, libssl-dev, zlib1g-dev, libfmt-dev, libtomlplusplus-dev")
if(TARGET rigfit_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  # The module is built for one version of the interpreter.
  string(REGEX MATCH "^([0-9]+)\\.([0-9]+)" python_version "${RIGFIT_PYTHON_VERSION}")
  math(EXPR next_minor "${CMAKE_MATCH_2} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-rigfit)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_DESCRIPTION "${PROJECT_DESCRIPTION} (Python package)")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= ${python_version}), python3 (<< ${CMAKE_MATCH_1}.${next_minor}), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pandas, python3-uncertainties")
endif()
include(CPack)
