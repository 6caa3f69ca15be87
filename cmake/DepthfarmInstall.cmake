# What `cmake --install` puts where, by component; each component is a Debian package (cpack -G DEB):
#   cli          depthfarm                 programs depthfarm and depthfarm-media, completions
#   worker       depthfarm-worker          the daemon and its unit
#   coordinator  depthfarm-coordinator     the same
#   library      libdepthfarm0.1           the shared library
#   development  libdepthfarm-dev          header, find_package(depthfarm)
#   python       python3-depthfarm         with DEPTHFARM_BUILD_PYTHON
include(CMakePackageConfigHelpers)

set(systemd_dir lib/systemd/system)
foreach(daemon coordinator worker)
  install(FILES deploy/systemd/depthfarm-${daemon}.service DESTINATION ${systemd_dir} COMPONENT ${daemon})
  # Either package may be alone on a host: both bring the user and the folder of keys.
  install(FILES deploy/systemd/depthfarm.sysusers DESTINATION lib/sysusers.d RENAME depthfarm-${daemon}.conf COMPONENT ${daemon})
  install(FILES deploy/systemd/depthfarm.tmpfiles DESTINATION lib/tmpfiles.d RENAME depthfarm-${daemon}.conf COMPONENT ${daemon})
  # Of the system, not of the prefix.
  install(FILES deploy/systemd/depthfarm-${daemon}.default DESTINATION ${CMAKE_INSTALL_FULL_SYSCONFDIR}/default
    RENAME depthfarm-${daemon} COMPONENT ${daemon})
endforeach()

install(FILES deploy/completions/depthfarm.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  RENAME depthfarm COMPONENT cli)
install(FILES deploy/completions/_depthfarm DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT cli)
install(FILES deploy/completions/depthfarm.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT cli)

# Manuals are what --help says, by help2man (Debian).
find_program(DEPTHFARM_HELP2MAN help2man)
if(DEPTHFARM_HELP2MAN AND NOT CMAKE_CROSSCOMPILING AND NOT DEPTHFARM_SANITIZE)
  set(manuals ${CMAKE_BINARY_DIR}/man)
  add_custom_command(OUTPUT ${manuals}/stamp
    COMMAND ${CMAKE_SOURCE_DIR}/cmake/manuals.sh ${DEPTHFARM_HELP2MAN} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY} ${manuals}
    DEPENDS depthfarm depthfarm-media depthfarm-coordinator depthfarm-worker cmake/manuals.sh
    VERBATIM)
  add_custom_target(manuals ALL DEPENDS ${manuals}/stamp)
  install(DIRECTORY ${manuals}/cli/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT cli)
  foreach(daemon coordinator worker)
    install(DIRECTORY ${manuals}/${daemon}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man8 COMPONENT ${daemon})
  endforeach()
elseif(NOT DEPTHFARM_HELP2MAN)
  message(STATUS "help2man is not installed: manuals are left out")
endif()

install(TARGETS depthfarm_shared EXPORT depthfarm-targets 
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT development INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES coordinator/library/depthfarm.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/depthfarm COMPONENT development)
install(EXPORT depthfarm-targets NAMESPACE depthfarm:: FILE depthfarm-config.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/depthfarm COMPONENT development)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/depthfarm-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/depthfarm-config-version.cmake DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/depthfarm
  COMPONENT development)
install(FILES docs/examples/depth_of_pictures.cc DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libdepthfarm-dev/examples
  COMPONENT development)
if(DEPTHFARM_BUILD_PYTHON)
  install(TARGETS depthfarm_python DESTINATION lib/python3/dist-packages COMPONENT python)
  install(FILES docs/examples/depth_of_pictures.py DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-depthfarm/examples COMPONENT python)
endif()

# ---- Debian packages ----
set(components cli worker coordinator library development)
set(package_cli depthfarm)
set(package_worker depthfarm-worker)
set(package_coordinator depthfarm-coordinator)
set(package_library libdepthfarm${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(package_development libdepthfarm-dev)
set(package_python python3-depthfarm)
if(DEPTHFARM_BUILD_PYTHON)
  list(APPEND components python)
endif()
set(debian_version ${PROJECT_VERSION}-1)
set(maintainer "depthfarm maintainers <maintainers@depthfarm.invalid>")
string(TIMESTAMP debian_date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # SOURCE_DATE_EPOCH, where it is set
set(control ${CMAKE_BINARY_DIR}/debian)
file(WRITE ${control}/changelog.Debian "depthfarm (${debian_version}) unstable; urgency=medium

  * What is new is in changelog.gz.

 -- ${maintainer}  ${debian_date}
")
file(COPY_FILE ${CMAKE_SOURCE_DIR}/CHANGELOG.md ${control}/changelog)
foreach(file changelog changelog.Debian)
  execute_process(COMMAND gzip -9nc ${control}/${file} OUTPUT_FILE ${control}/${file}.gz COMMAND_ERROR_IS_FATAL ANY)
endforeach()
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS CHANGELOG.md)
foreach(component ${components})
  # Debian's policy asks for these in every package.
  install(FILES deploy/debian/copyright ${control}/changelog.gz ${control}/changelog.Debian.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package_${component}} COMPONENT ${component})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME depthfarm)
set(CPACK_PACKAGE_CONTACT ${maintainer})
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(exactly "(= ${debian_version})")
set(CPACK_DEBIAN_CLI_PACKAGE_NAME depthfarm)
set(CPACK_DEBIAN_CLI_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_CLI_PACKAGE_DEPENDS "depthfarm-worker ${exactly}, depthfarm-coordinator ${exactly}")
set(CPACK_DEBIAN_CLI_PACKAGE_SUGGESTS "slurm-client, openssh-client")
set(CPACK_DEBIAN_CLI_DESCRIPTION "depth maps for multi-camera video
Estimates consistent depth for all cameras of a calibrated array together, on
this machine or on a farm of many; synthesises and measures virtual views.")
set(CPACK_DEBIAN_WORKER_PACKAGE_NAME depthfarm-worker)
set(CPACK_DEBIAN_WORKER_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_WORKER_DESCRIPTION "depth maps for multi-camera video (worker)
The daemon of a depthfarm that computes: it leases tasks from a coordinator and
serves its results to other workers.")
set(CPACK_DEBIAN_COORDINATOR_PACKAGE_NAME depthfarm-coordinator)
set(CPACK_DEBIAN_COORDINATOR_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_COORDINATOR_DESCRIPTION "depth maps for multi-camera video (coordinator)
The daemon of a depthfarm that plans jobs, hands their tasks to workers and
journals what was done.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME ${package_library})
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "depth maps for multi-camera video (library)
The estimation core for programs of one's own: cameras and pictures in memory
in, depth maps out.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libdepthfarm-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${package_library} ${exactly}")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "depth maps for multi-camera video (headers)
Header and CMake files of libdepthfarm: the estimation core for programs of
one's own.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-depthfarm)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "depth maps for multi-camera video (Python)
The estimation core for Python: cameras and numpy arrays in, depth maps out.")
foreach(daemon coordinator worker)
  string(TOUPPER ${daemon} upper)
  set(of_daemon ${control}/${daemon})
  configure_file(deploy/debian/postinst.in ${of_daemon}/postinst @ONLY FILE_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  configure_file(deploy/debian/prerm.in ${of_daemon}/prerm @ONLY FILE_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
  file(WRITE ${of_daemon}/conffiles "/etc/default/depthfarm-${daemon}\n")
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA ${of_daemon}/postinst ${of_daemon}/prerm ${of_daemon}/conffiles)
endforeach()
file(WRITE ${control}/library/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${control}/library/triggers)
include(CPack)
