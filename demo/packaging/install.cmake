# cmake --install of the program (component program), and the packages that cpack makes of both components: .deb and a
# relocatable .tar.gz.
include(GNUInstallDirs)
set(LUCERNA_APP_ID alt.lucerna.Lucerna)  # why this name: alt.lucerna.Lucerna.metainfo.xml
set(packaging ${CMAKE_CURRENT_LIST_DIR})
set(generated ${CMAKE_CURRENT_BINARY_DIR}/packaging)
file(MAKE_DIRECTORY ${generated})
# The project has no address; example.org is reserved [RFC 2606].
set(LUCERNA_MAINTAINER "Lucerna maintainers <lucerna@example.org>"
    CACHE STRING "Who answers for the packages: whoever distributes them")

# The manual page and completions come from the command line's own tree: the program prints them.
find_program(LUCERNA_GZIP gzip REQUIRED)
set(pages "")
foreach(page IN ITEMS
        "manual|lucerna.1" "completion bash|lucerna.bash" "completion zsh|_lucerna" "completion fish|lucerna.fish")
  string(REGEX MATCH "^(.*)\\|(.*)$" matched ${page})
  set(file ${generated}/${CMAKE_MATCH_2})
  separate_arguments(arguments UNIX_COMMAND "${CMAKE_MATCH_1}")
  add_custom_command(OUTPUT ${file} COMMAND lucerna ${arguments} > ${file} DEPENDS ${lucerna_programs} VERBATIM)
  list(APPEND pages ${file})
endforeach()
# -n: no time stamp, so that the same sources give the same file.
add_custom_command(OUTPUT ${generated}/lucerna.1.gz
                   COMMAND ${LUCERNA_GZIP} -9nc ${generated}/lucerna.1 > ${generated}/lucerna.1.gz
                   DEPENDS ${generated}/lucerna.1 VERBATIM)
execute_process(COMMAND ${CMAKE_COMMAND} -E env LC_ALL=C date --utc --rfc-email --date ${LUCERNA_RELEASE_DATE}
                OUTPUT_VARIABLE LUCERNA_RELEASE_DATE_RFC5322 OUTPUT_STRIP_TRAILING_WHITESPACE
                COMMAND_ERROR_IS_FATAL ANY)
# The page of lucerna describes the programs beside it too.
file(WRITE ${generated}/beside.1 ".so man1/lucerna.1\n")
add_custom_command(OUTPUT ${generated}/beside.1.gz
                   COMMAND ${LUCERNA_GZIP} -9nc ${generated}/beside.1 > ${generated}/beside.1.gz
                   DEPENDS ${generated}/beside.1 VERBATIM)
configure_file(${packaging}/changelog.in ${generated}/changelog @ONLY)
add_custom_command(OUTPUT ${generated}/changelog.gz
                   COMMAND ${LUCERNA_GZIP} -9nc ${generated}/changelog > ${generated}/changelog.gz
                   DEPENDS ${generated}/changelog VERBATIM)
configure_file(${packaging}/${LUCERNA_APP_ID}.metainfo.xml.in ${generated}/${LUCERNA_APP_ID}.metainfo.xml @ONLY)
add_custom_target(lucerna_pages ALL DEPENDS ${pages} ${generated}/lucerna.1.gz ${generated}/beside.1.gz
                  ${generated}/changelog.gz)

# The program and its data, without generators and the READMEs' pictures.
install(TARGETS ${lucerna_programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders ${PROJECT_SOURCE_DIR}/assets ${PROJECT_SOURCE_DIR}/keyFrames
        DESTINATION ${CMAKE_INSTALL_DATADIR}/lucerna COMPONENT program
        PATTERN generate.py EXCLUDE PATTERN generator EXCLUDE PATTERN __pycache__ EXCLUDE PATTERN "*.jpg" EXCLUDE)

# The teaching labs: the students' files and their checks.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/demo/labs DESTINATION ${CMAKE_INSTALL_DATADIR}/lucerna/demo COMPONENT program
        FILES_MATCHING PATTERN "*.glsl" PATTERN "*.comp" PATTERN "*.md" PATTERN "*.txt")

# The desktop: entry, description, icon.
install(FILES ${packaging}/${LUCERNA_APP_ID}.desktop
        DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT program)
install(FILES ${generated}/${LUCERNA_APP_ID}.metainfo.xml
        DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo COMPONENT program)
install(FILES ${packaging}/${LUCERNA_APP_ID}.svg
        DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps COMPONENT program)

# The shell: manual page and completions. Debian's zsh uses its own folder.
if(EXISTS /etc/debian_version)
  set(zsh_folder vendor-completions)
else()
  set(zsh_folder site-functions)
endif()
set(LUCERNA_ZSH_COMPLETIONS ${CMAKE_INSTALL_DATADIR}/zsh/${zsh_folder}
    CACHE STRING "Where zsh looks for completions, relative to the prefix")
install(FILES ${generated}/lucerna.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
foreach(program IN ITEMS bench labs originals)
  install(FILES ${generated}/beside.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 RENAME lucerna-${program}.1.gz
          COMPONENT program)
endforeach()
install(FILES ${generated}/lucerna.bash
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME lucerna COMPONENT program)
install(FILES ${generated}/_lucerna DESTINATION ${LUCERNA_ZSH_COMPLETIONS} COMPONENT program)
install(FILES ${generated}/lucerna.fish
        DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)

# Required by Debian in every package; other systems find the licence there too.
foreach(name_component IN ITEMS "lucerna;program" "liblucerna-dev;development")
  list(GET name_component 0 name)
  list(GET name_component 1 component)
  install(FILES ${packaging}/copyright ${generated}/changelog.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
endforeach()

# ---------------------------------------------------------------------------------------------------- packages
set(CPACK_PACKAGE_NAME lucerna)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT ${LUCERNA_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "real-time global illumination, measured")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_GENERATOR "TGZ;DEB" CACHE STRING "What cpack makes")
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_STRIP_FILES ON)

# One archive of everything, relocatable to any prefix.
set(CPACK_PACKAGE_FILE_NAME lucerna-${PROJECT_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR})
string(TOLOWER ${CPACK_PACKAGE_FILE_NAME} CPACK_PACKAGE_FILE_NAME)
set(CPACK_ARCHIVE_COMPONENT_INSTALL OFF)

# Two Debian packages: the program, and the library for programs built on it.
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME lucerna)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# Loaded by name or run as a program, so dpkg-shlibdeps does not see them: a driver, Mesa's renderer in memory, plots of
# bench.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libgl1-mesa-dri, libosmesa6")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "gnuplot-nox | gnuplot")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "\
Lucerna walks through scenes lit by global illumination, renders pictures of
them and measures what each technique costs and how far it is from the
reference. It re-creates light propagation volumes, reflective shadow maps,
radiosity by hemicubes and path tracing of participating media, as published
and physically correct. No GPU is needed: Mesa's software renderer will do.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME liblucerna-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "lucerna (= ${PROJECT_VERSION}), libglew-dev, libglfw3-dev, libglm-dev, \
libassimp-dev, libdevil-dev, libegl-dev, libopenexr-dev, libfmt-dev, nlohmann-json3-dev, pkg-config")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "\
Lucerna renders scenes with global illumination by OpenGL 4.3, in a window or
off-screen.

This package has the static library, its headers and the CMake package lucerna
with the target lucerna::engine.")
include(CPack)
