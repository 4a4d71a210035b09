"""Recipe for Conan 2: headers, weights and the CMake package. `conan create .` makes the package."""
import os
import re

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import load


class Motionlang(ConanFile):
    name = "motionlang"
    description = "Header-only C++20 templates that turn words into 3D human motion"
    license = "MIT"
    topics = ("motion", "animation", "diffusion", "header-only")
    package_type = "header-library"
    settings = "os", "compiler", "build_type", "arch"
    exports_sources = "CMakeLists.txt", "LICENSE", "include/*", "examples/models/*"

    def set_version(self):
        header = load(self, os.path.join(self.recipe_folder, "include", "motionlang", "version.hpp"))
        self.version = re.search(r'MOTIONLANG_VERSION "(.+)"', header).group(1)

    def requirements(self):
        self.requires("eigen/3.4.0")
        self.requires("xtensor/0.24.7")
        self.requires("nlohmann_json/3.11.3")

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["MOTIONLANG_BUILD_TESTS"] = False
        toolchain.cache_variables["MOTIONLANG_BUILD_EXAMPLES"] = False
        toolchain.cache_variables["MOTIONLANG_INSTALL"] = True
        toolchain.generate()

    def build(self):
        CMake(self).configure()

    def package(self):
        CMake(self).install()

    def package_id(self):
        self.info.clear()  # headers: one package for all compilers

    def package_info(self):
        self.cpp_info.set_property("cmake_find_mode", "none")  # motionlangConfig.cmake is in the package
        self.cpp_info.builddirs = [os.path.join("share", "cmake", "motionlang")]
        self.cpp_info.bindirs = self.cpp_info.libdirs = []
