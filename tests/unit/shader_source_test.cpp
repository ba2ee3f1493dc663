// The preprocessor before the driver's: includes, declared flags, line maps, readable logs. No GL.
#include "gl/program.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace lucerna::gl {
namespace {

using test::badInputMessage;
using test::TempFolder;
using ::testing::AssertionFailure;
using ::testing::AssertionResult;
using ::testing::AssertionSuccess;

struct ShaderFolder : TempFolder {
  ExpandedSource expand(const std::string& file, const ShaderFlags& flags = {}) const {
    return expandShader(path(), file, flags);
  }
  std::string error(const std::string& file, const ShaderFlags& flags = {}) const {
    return badInputMessage([&] { expand(file, flags); });
  }
};

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

AssertionResult has(const std::string& text, std::string_view part) {
  if (text.find(part) != std::string::npos) return AssertionSuccess();
  return AssertionFailure() << "\"" << text << "\" has no \"" << part << "\"";
}

TEST(ShaderSource, VersionAndFlagsComeFirst) {
  const ShaderFolder folder;
  folder.write("a.frag", "void main() {}\n");
  const ExpandedSource source = folder.expand("a.frag", {{"TEXTURES", 1}, {"GROUP", 8}, {"OFF", 0}});
  EXPECT_EQ(source.text, "#version 430 core\n#define TEXTURES 1\n#define GROUP 8\n#define OFF 0\nvoid main() {}\n");
}

TEST(ShaderSource, EachFileIsIncludedOnce) {
  const ShaderFolder folder;
  folder.write("lib/base.glsl", "float base;\n");
  folder.write("lib/x.glsl", "#include \"lib/base.glsl\"\nfloat x;\n");
  folder.write("lib/y.glsl", "#include \"lib/base.glsl\"\nfloat y;\n");
  folder.write(
      "a.frag",
      "#include \"lib/x.glsl\"\n  #  include \"lib/y.glsl\"  // again\n#include \"lib/x.glsl\"\nvoid main() {}\n");
  const ExpandedSource source = folder.expand("a.frag");
  EXPECT_EQ(source.text, "#version 430 core\nfloat base;\nfloat x;\nfloat y;\nvoid main() {}\n");
  ASSERT_EQ(source.files.size(), 4u);
  EXPECT_EQ(source.files[0], "a.frag");
  EXPECT_EQ(source.files[1], "lib/x.glsl");
  EXPECT_EQ(source.files[2], "lib/base.glsl");
}

TEST(ShaderSource, LineMapNamesEveryLinesOrigin) {
  const ShaderFolder folder;
  folder.write("lib/x.glsl", "// head\nfloat x;\n");
  folder.write("a.frag",
               "// one\n#include \"lib/x.glsl\"\nfloat three;\r\nfloat four;");  // CR LF, and no end of line at the end
  const ExpandedSource source = folder.expand("a.frag", {{"FLAG", 1}});
  const auto lines = linesOf(source.text);
  ASSERT_EQ(lines.size(), source.lines.size());
  const auto whereIs = [&](const std::string& line) {
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (lines[i] == line) {
        const ExpandedSource::Line& origin = source.lines[i];
        return origin.file < 0
                   ? "ours"
                   : source.files[static_cast<std::size_t>(origin.file)].string() + ":" + std::to_string(origin.line);
      }
    return std::string("missing");
  };
  EXPECT_EQ(whereIs("#version 430 core"), "ours");
  EXPECT_EQ(whereIs("#define FLAG 1"), "ours");
  EXPECT_EQ(whereIs("// one"), "a.frag:1");
  EXPECT_EQ(whereIs("float x;"), "lib/x.glsl:2");
  EXPECT_EQ(whereIs("float three;"), "a.frag:3");
  EXPECT_EQ(whereIs("float four;"), "a.frag:4");
}

TEST(ShaderSource, ACycleIsAnError) {
  const ShaderFolder folder;
  folder.write("a.glsl", "float a;\n#include \"b.glsl\"\n");
  folder.write("b.glsl", "\n\n#include \"a.glsl\"\n");
  folder.write("self.glsl", "#include \"self.glsl\"\n");
  EXPECT_TRUE(has(folder.error("a.glsl"), "shaders/b.glsl:3: include cycle back to shaders/a.glsl"));
  EXPECT_TRUE(has(folder.error("self.glsl"), "shaders/self.glsl:1: include cycle back to shaders/self.glsl"));
}

TEST(ShaderSource, AMissingFileIsAnErrorThatSaysWhoWantsIt) {
  const ShaderFolder folder;
  folder.write("a.frag", "\n#include \"lib/no.glsl\"\n");
  folder.write("folder/file.glsl", "");
  folder.write("b.frag", "#include \"folder\"\n");
  EXPECT_TRUE(has(folder.error("a.frag"), "shaders/a.frag:2: shader file shaders/lib/no.glsl is missing"));
  EXPECT_TRUE(has(folder.error("b.frag"), "shaders/b.frag:1: shader file shaders/folder is missing"));
  EXPECT_TRUE(has(folder.error("none.frag"), "shader file shaders/none.frag is missing"));
}

TEST(ShaderSource, AnUndeclaredFlagIsAnErrorWithFileAndLine) {
  const ShaderFolder folder;
  folder.write("lib/x.glsl", "float x;\n#if TEXTURE\nfloat y;\n#endif\n");
  folder.write("a.frag", "#include \"lib/x.glsl\"\n");
  const std::string message = folder.error("a.frag", {{"TEXTURES", 1}});
  EXPECT_TRUE(has(message, "shaders/lib/x.glsl:2: flag TEXTURE is not declared by the program"));
  EXPECT_TRUE(has(message, "TEXTURES"));
  EXPECT_EQ(folder.error("a.frag", {{"TEXTURE", 0}}), "");
  for (const char* condition :
       {"#ifdef WRONG", "#ifndef WRONG", "#if defined(WRONG)", "  #  if RIGHT && WRONG", "#if RIGHT\n#elif WRONG"}) {
    folder.write("b.frag", std::string(condition) + "\n#endif\n");
    EXPECT_TRUE(has(folder.error("b.frag", {{"RIGHT", 1}}), "flag WRONG is not declared")) << condition;
  }
}

TEST(ShaderSource, OwnMacrosExtensionsAndCommentsAreNoFlags) {
  const ShaderFolder folder;
  folder.write("a.frag",
               "#define OWN 1\n#if OWN  // WRONG in a comment\n#endif\n#ifdef GL_NV_shader_atomic_float\n#endif\n#if "
               "__VERSION__ >= 430\n#endif\n"
               "#if defined(OWN) && RIGHT > 2\n#endif\n");
  EXPECT_EQ(folder.error("a.frag", {{"RIGHT", 3}}), "");
}

TEST(ShaderSource, VersionIsRefused) {
  const ShaderFolder folder;
  folder.write("a.frag", "// head\n#version 430 core\nvoid main() {}\n");
  EXPECT_TRUE(has(folder.error("a.frag"), "shaders/a.frag:2: #version is written by the library"));
}

TEST(ShaderSource, LogsOfThreeDriversAreRewritten) {
  const ShaderFolder folder;
  folder.write("lib/x.glsl", "float a;\nfloat b = c;\n");
  folder.write("a.frag", "// one\n#include \"lib/x.glsl\"\nvoid main() {}\n");
  const ExpandedSource source = folder.expand("a.frag", {{"F", 1}});
  // Lines: 1 #version, 2 #define, 3 // one, 4 float a, 5 float b = c, 6 void main.
  EXPECT_EQ(rewriteShaderLog("0:5(11): error: `c' undeclared\n", source),
            "shaders/lib/x.glsl:2: error: `c' undeclared\n");
  EXPECT_EQ(rewriteShaderLog("0(5) : error C1503: undefined variable \"c\"\n", source),
            "shaders/lib/x.glsl:2: error C1503: undefined variable \"c\"\n");
  EXPECT_EQ(rewriteShaderLog("ERROR: 0:6: 'main' : function\n", source),
            "shaders/a.frag:3: ERROR: 'main' : function\n");
  EXPECT_EQ(rewriteShaderLog("WARNING: 0:3: something\n", source), "shaders/a.frag:1: WARNING: something\n");
  // Lines of ours, beyond the end, and what names no line stay as they are.
  EXPECT_EQ(rewriteShaderLog("0:1(1): error: version\n", source), "0:1(1): error: version\n");
  EXPECT_EQ(rewriteShaderLog("0:99(1): error: end\nlinking failed\n", source), "0:99(1): error: end\nlinking failed\n");
  EXPECT_EQ(rewriteShaderLog("", source), "");
}

}  // namespace
}  // namespace lucerna::gl
