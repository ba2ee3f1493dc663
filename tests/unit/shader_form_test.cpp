// The form of shaders, where GLSL leaves open what happens and drivers differ: floats that an integer cannot hold,
// loops without a bound, derivatives in flow that is not uniform. Read from their text, as far as types can be told.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Token {
  std::string text;
  std::size_t line;
};
using Tokens = std::vector<Token>;

struct Shader {
  std::string file;
  std::vector<std::string> lines;
  Tokens tokens;  ///< without comments and directives, but with what macros stand for
};

bool isName(const std::string& text) { return std::isalpha(static_cast<unsigned char>(text[0])) || text[0] == '_'; }

Shader read(const std::string& file, std::istream& stream) {
  static const std::regex token(R"([A-Za-z_]\w*|\d[\w.]*|\.\d\w*|&&|\|\||[<>=!+\-*/|&^]=|<<|>>|\+\+|--|[^\s\w])"),
      directive(R"(^\s*#\s*(define\s+\w+(\([^)]*\))?)?)");
  Shader shader{file, {}, {}};
  bool isContinued = false;
  for (std::string line; std::getline(stream, line);) {
    shader.lines.push_back(line);
    std::string code = line.substr(0, line.find("//"));
    code = std::regex_replace(code, std::regex(R"(/\*.*?\*/)"), "");
    std::smatch match;
    if (!isContinued && std::regex_search(code, match, directive))
      code = match[1].matched ? match.suffix().str() : std::string();
    isContinued = !line.empty() && line.back() == '\\';
    if (isContinued) code.pop_back();
    for (auto at = std::sregex_iterator(code.begin(), code.end(), token); at != std::sregex_iterator(); ++at)
      shader.tokens.push_back({at->str(), shader.lines.size()});
  }
  return shader;
}

std::vector<Shader> shaders() {
  const fs::path root = LUCERNA_SOURCE_DIR;
  const std::set<std::string> kinds{".h", ".glsl", ".comp", ".vert", ".geom", ".frag"};
  std::vector<Shader> result;
  for (const char* folder : {"shaders", "tests/gl/example_technique"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!entry.is_regular_file() || !kinds.contains(entry.path().extension().string())) continue;
      std::ifstream stream(entry.path());
      result.push_back(read(fs::relative(entry.path(), root).string(), stream));
    }
  EXPECT_GT(result.size(), 150u);
  return result;
}

/// Whether a line, or the comment before it, gives the reason for an exception.
bool says(const Shader& shader, std::size_t line, const char* word) {
  const auto has = [&](std::size_t number) { return shader.lines[number - 1].find(word) != std::string::npos; };
  if (has(line)) return true;
  for (std::size_t before = line - 1; before > 0; --before) {
    const std::string& text = shader.lines[before - 1];
    if (text.find_first_not_of(' ') != text.find("//")) return false;
    if (has(before)) return true;
  }
  return false;
}

/// The token behind the bracket that closes the one at `open`.
std::size_t behind(const Tokens& tokens, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < tokens.size(); ++i) {
    const std::string& text = tokens[i].text;
    if (text == "(" || text == "[" || text == "{") ++depth;
    if (text == ")" || text == "]" || text == "}") --depth;
    if (depth == 0) return i + 1;
  }
  return tokens.size();
}

// ------------------------------------------------------------------------------------------------------------- types

bool isWhole(const std::string& type) {
  static const std::regex whole("u?int|bool|[iub]vec[234]|[iu](sampler|image).*");
  return std::regex_match(type, whole);
}
bool isConversion(const std::string& name) {
  static const std::regex conversion("u?int|[iu]vec[234]");
  return std::regex_match(name, conversion);
}
bool isBuiltIn(const std::string& name) {
  static const std::regex type("void|float|vec[234]|mat[234](x[234])?|[iu]?(sampler|image)\\w+");
  return isWhole(name) || std::regex_match(name, type);
}

class Types {
 public:
  explicit Types(const std::vector<Shader>& all) {
    for (const Shader& shader : all)
      for (std::size_t i = 0; i + 1 < shader.tokens.size(); ++i)
        if (shader.tokens[i].text == "struct") members_[shader.tokens[i + 1].text];
    for (const Shader& shader : all) {
      const Tokens& tokens = shader.tokens;
      for (const auto& [name, declarations] : of(shader))
        for (const auto& [at, type] : declarations) everywhere_[name].insert(type);
      for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
        if (tokens[i].text == "uniform") addUniforms(tokens, i);
        if (tokens[i].text != "struct") continue;
        const Shader body{"",
                          {},
                          Tokens(tokens.begin() + static_cast<std::ptrdiff_t>(i) + 2,
                                 tokens.begin() + static_cast<std::ptrdiff_t>(behind(tokens, i + 2)))};
        for (const auto& [name, declarations] : of(body))
          members_[tokens[i + 1].text][name] = declarations.front().second;
      }
    }
  }

  /// The types that a file gives a name, from which token on.
  using Declared = std::map<std::string, std::vector<std::pair<std::size_t, std::string>>>;
  Declared of(const Shader& shader) const {
    Declared result;
    declare(shader, result);
    return result;
  }
  bool isUniform(const std::string& name) const { return uniforms_.contains(name); }

  /// Whether an expression can only be of integers.
  bool isWholeExpression(const Tokens& tokens, std::size_t begin, std::size_t end, const Declared& own) const {
    static const std::set<std::string> whole{"floatBitsToInt",
                                             "floatBitsToUint",
                                             "lessThan",
                                             "lessThanEqual",
                                             "equal",
                                             "greaterThan",
                                             "greaterThanEqual",
                                             "notEqual",
                                             "textureSize",
                                             "imageSize",
                                             "bitCount",
                                             "packHalf2x16",
                                             "packSnorm2x16",
                                             "packUnorm2x16",
                                             "any",
                                             "all"},
        transparent{"min", "max", "clamp", "abs", "sign"}, reads{"texelFetch", "imageLoad", "texture"};
    for (std::size_t i = begin; i < end;) {
      const std::string& text = tokens[i].text;
      if (text.find('.') != std::string::npos && text != ".") return false;
      if (!isName(text) || (i > begin && tokens[i - 1].text == ".")) {
        ++i;
        continue;
      }
      const bool isCall = i + 1 < end && tokens[i + 1].text == "(";
      if (isCall && (isConversion(text) || whole.contains(text))) {
        i = behind(tokens, i + 1);
      } else if (isCall && transparent.contains(text)) {
        ++i;
      } else if (isCall && reads.contains(text)) {
        if (!areWhole(typesOf(tokens[i + 2].text, i, own))) return false;
        i = behind(tokens, i + 1);
      } else if (text.starts_with("gl_") || (!isCall && isMacro(text, i, own))) {
        ++i;
      } else {
        std::set<std::string> types = typesOf(text, i, own);
        i = isCall ? behind(tokens, i + 1) : i + 1;
        // Elements and members.
        for (; i < end && (tokens[i].text == "[" || tokens[i].text == ".");) {
          if (tokens[i].text == "[") {
            i = behind(tokens, i);
            continue;
          }
          if (tokens[i + 1].text == "length") {
            types = {"int"};
            i = behind(tokens, i + 2);
            continue;
          }
          std::set<std::string> ofMember;
          for (const std::string& type : types) {
            const auto structure = members_.find(type);
            ofMember.insert(structure == members_.end() ? type : memberOf(structure->second, tokens[i + 1].text));
          }
          types = ofMember;
          i += 2;
        }
        if (!areWhole(types)) return false;
      }
    }
    return true;
  }

 private:
  static bool areWhole(const std::set<std::string>& types) {
    return !types.empty() && std::ranges::all_of(types, isWhole);
  }
  /// A flag or a number's name.
  bool isMacro(const std::string& name, std::size_t at, const Declared& own) const {
    return typesOf(name, at, own).empty() && std::regex_match(name, std::regex("[A-Z][A-Z0-9_]*"));
  }
  /// By the file's last declaration before a token; else all that other files give it.
  std::set<std::string> typesOf(const std::string& name, std::size_t at, const Declared& own) const {
    if (const auto found = own.find(name); found != own.end())
      for (auto last = found->second.rbegin(); last != found->second.rend(); ++last)
        if (last->first < at) return {last->second};
    const auto other = everywhere_.find(name);
    return other == everywhere_.end() ? std::set<std::string>() : other->second;
  }
  using Members = std::map<std::string, std::string>;
  static std::string memberOf(const Members& members, const std::string& name) {
    const auto at = members.find(name);
    return at == members.end() ? std::string("unknown") : at->second;
  }
  bool isType(const std::string& name) const { return isBuiltIn(name) || members_.contains(name); }

  // A type and a name; more names follow behind commas.
  void declare(const Shader& shader, Declared& to) const {
    const Tokens& tokens = shader.tokens;
    for (std::size_t i = 0; i + 2 < tokens.size(); ++i) {
      if (!isType(tokens[i].text) || !isName(tokens[i + 1].text)) continue;
      for (std::size_t name = i + 1; name < tokens.size();) {
        to[tokens[name].text].emplace_back(name, tokens[i].text);
        std::size_t at = name + 1;
        while (at < tokens.size() && tokens[at].text != "," && tokens[at].text != ";" && tokens[at].text != ")" &&
               tokens[at].text != "}")
          at = tokens[at].text == "(" || tokens[at].text == "[" || tokens[at].text == "{" ? behind(tokens, at) : at + 1;
        if (at + 2 >= tokens.size() || tokens[at].text != "," || !isName(tokens[at + 1].text) ||
            isType(tokens[at + 1].text) || tokens[at + 1].text == "out" || tokens[at + 1].text == "inout" ||
            tokens[at + 1].text == "precise")
          break;
        name = at + 1;
      }
    }
  }
  void addUniforms(const Tokens& tokens, std::size_t at) {
    std::size_t end = at;
    while (tokens[end].text != ";" && tokens[end].text != "{") ++end;
    if (tokens[end].text == "{") end = behind(tokens, end);
    for (; at < end; ++at)
      if (isName(tokens[at].text) && !isType(tokens[at].text)) uniforms_.insert(tokens[at].text);
  }

  std::set<std::string> uniforms_;
  std::map<std::string, Members> members_;  ///< of structures
  std::map<std::string, std::set<std::string>> everywhere_;
};

std::vector<std::size_t> bareConversions(const Shader& shader, const Types& types) {
  const Types::Declared own = types.of(shader);
  std::vector<std::size_t> lines;
  for (std::size_t i = 0; i + 1 < shader.tokens.size(); ++i) {
    const Token& token = shader.tokens[i];
    if (!isConversion(token.text) || shader.tokens[i + 1].text != "(") continue;
    if (!types.isWholeExpression(shader.tokens, i + 2, behind(shader.tokens, i + 1) - 1, own) &&
        !says(shader, token.line, "bounded: "))
      lines.push_back(token.line);
  }
  return lines;
}

// ------------------------------------------------------------------------------------------------------------- loops

// Whether an expression follows from constants, uniforms and sizes of buffers alone.
bool isBound(const Tokens& tokens, std::size_t begin, std::size_t end, const Types& types) {
  static const std::set<std::string> known{"int", "uint", "textureSize", "imageSize", "length", "bvhStepCount"};
  static const std::regex constant("k[A-Z]\\w*|[A-Z][A-Z0-9_]*|gl_\\w+");
  for (std::size_t i = begin; i < end; ++i) {
    const std::string& text = tokens[i].text;
    if (!isName(text) || known.contains(text) || std::regex_match(text, constant)) continue;
    const bool isMember = i >= begin + 2 && tokens[i - 1].text == ".";
    const bool isSized = i + 2 < end && tokens[i + 1].text == "." && tokens[i + 2].text == "length";
    if (!isMember && !isSized && !types.isUniform(text)) return false;
  }
  return begin < end;
}

// for (...; i < BOUND && ...; ++i), or for (int i = BOUND; i > 0 && ...; --i).
bool isBoundedFor(const Tokens& tokens, std::size_t open, const Types& types) {
  const std::size_t end = behind(tokens, open) - 1;
  std::vector<std::size_t> semicolons;
  for (std::size_t i = open; i < end; ++i)
    if (tokens[i].text == ";") semicolons.push_back(i);
  if (semicolons.size() != 2 || semicolons[1] - semicolons[0] < 4) return false;
  const std::string counter = tokens[semicolons[0] + 1].text, comparison = tokens[semicolons[0] + 2].text;
  std::size_t bound = semicolons[0] + 3;
  while (bound < semicolons[1] && tokens[bound].text != "&&" && tokens[bound].text != "||")
    bound = tokens[bound].text == "(" ? behind(tokens, bound) : bound + 1;
  for (std::size_t i = bound; i < semicolons[1]; ++i)
    if (tokens[i].text == "||") return false;
  const Token &step = tokens[semicolons[1] + 1], &next = tokens[semicolons[1] + 2];
  const bool up = (step.text == "++" && next.text == counter) || (step.text == counter && next.text == "+=");
  if (up && (comparison == "<" || comparison == "<=")) return isBound(tokens, semicolons[0] + 3, bound, types);
  const bool down = step.text == "--" && next.text == counter && comparison == ">" &&
                    tokens[semicolons[0] + 3].text == "0" && tokens[open + 2].text == counter;
  return down && isBound(tokens, open + 4, semicolons[0], types);
}

std::vector<std::size_t> openLoops(const Shader& shader, const Types& types) {
  std::vector<std::size_t> lines;
  const Tokens& tokens = shader.tokens;
  for (std::size_t i = 0; i + 1 < tokens.size(); ++i) {
    const bool isFor = tokens[i].text == "for", isWhile = tokens[i].text == "while";  // do ends with while
    if (!(isFor || isWhile) || (isFor && isBoundedFor(tokens, i + 1, types))) continue;
    if (!says(shader, tokens[i].line, "ends: ")) lines.push_back(tokens[i].line);
  }
  return lines;
}

// ------------------------------------------------------------------------------------------------------- derivatives

struct Function {
  std::string name;
  std::size_t begin, end;  ///< tokens of the body
};

std::vector<Function> functionsOf(const Tokens& tokens) {
  std::vector<Function> result;
  for (std::size_t i = 1; i + 2 < tokens.size(); ++i) {
    if (!isName(tokens[i - 1].text) || !isName(tokens[i].text) || tokens[i + 1].text != "(") continue;
    const std::size_t body = behind(tokens, i + 1);
    if (body >= tokens.size() || tokens[body].text != "{") continue;
    result.push_back({tokens[i].text, body, behind(tokens, body)});
    i = result.back().end - 1;
  }
  return result;
}

/// Derivatives, or functions that take some, behind an exit that some lanes may have taken.
std::vector<std::size_t> lateDerivatives(const Shader& shader, const std::set<std::string>& derive) {
  std::vector<std::size_t> lines;
  const Tokens& tokens = shader.tokens;
  for (const Function& function : functionsOf(tokens)) {
    std::size_t exit = function.end;  // the first statement that lanes may leave by ends here
    for (std::size_t i = function.begin; i + 1 < function.end; ++i) {
      if (tokens[i].text == "if") {
        const std::size_t then = behind(tokens, i + 1);
        std::size_t last = tokens[then].text == "{" ? behind(tokens, then) : then;
        while (tokens[then].text != "{" && tokens[last].text != ";") ++last;
        for (std::size_t k = then; k < last; ++k)
          if ((tokens[k].text == "return" || tokens[k].text == "discard") && !says(shader, tokens[k].line, "uniform: "))
            exit = std::min(exit, last);
      }
      if (i >= exit && tokens[i + 1].text == "(" && derive.contains(tokens[i].text)) lines.push_back(tokens[i].line);
    }
  }
  return lines;
}

std::set<std::string> thatDerive(const std::vector<Shader>& all) {
  std::set<std::string> derive{"texture", "textureOffset", "textureProj", "dFdx", "dFdy", "fwidth"};
  for (std::size_t before = 0; before != derive.size();) {
    before = derive.size();
    for (const Shader& shader : all) {
      if (shader.file.ends_with(".comp")) continue;
      for (const Function& function : functionsOf(shader.tokens))
        for (std::size_t i = function.begin; i + 1 < function.end; ++i)
          if (shader.tokens[i + 1].text == "(" && derive.contains(shader.tokens[i].text) && function.name != "main")
            derive.insert(function.name);
    }
  }
  return derive;
}

Shader shaderOf(const std::string& text) {
  std::istringstream stream(text);
  return read("test", stream);
}

// ------------------------------------------------------------------------------------------------------------- tests

// lib/clamped_int.glsl converts floats; `// bounded: reason` allows what is bounded by construction.
TEST(ShaderForm, FloatsAreClampedBeforeTheyBecomeIntegers) {
  std::vector<Shader> all = shaders();
  const Types types(all);
  for (const Shader& shader : all)
    for (const std::size_t line : bareConversions(shader, types)) ADD_FAILURE() << shader.file << ":" << line;
  const auto count = [&](const char* text) { return bareConversions(shaderOf(text), types).size(); };
  EXPECT_EQ(count("r.low = ivec2(ceil((low - vec2(-1.0, bottom)) * halfSize - 0.501));"), 1u);  // hung radiosity
  EXPECT_EQ(count("vec2 at = f();\nint i = 3;\nivec3 texel = ivec3(at, i);"), 1u);
  EXPECT_EQ(count("vec2 at = f();\nint i = 3;\nivec3 texel = ivec3(at, i);  // bounded: f is small"), 0u);
  EXPECT_EQ(count("ivec2 at = f(), to = g();\nuint n = uint(at.x + 2 * to[1]);"), 0u);
  EXPECT_EQ(count("uint n = uint(grids.shape.x), m = uint(grids.blendBand);"), 1u);
}

// Of a loop the first condition is a bound of constants, uniforms or sizes, or `// ends: reason` says why it ends.
TEST(ShaderForm, LoopsEndWhateverTheDataAre) {
  std::vector<Shader> all = shaders();
  const Types types(all);
  for (const Shader& shader : all)
    for (const std::size_t line : openLoops(shader, types)) ADD_FAILURE() << shader.file << ":" << line;
  const auto count = [&](const char* text) { return openLoops(shaderOf(text), types).size(); };
  EXPECT_EQ(count("while (!(given[pick] > 0.0)) --pick;  // by rounding beyond the last of them"), 1u);
  EXPECT_EQ(count("for (;;) {}"), 1u);
  EXPECT_EQ(count("for (uint i = 0u; i < listed; ++i) {}"), 1u);
  EXPECT_EQ(count("for (uint i = 0u; i < uint(list.length()) && i < listed; ++i) {}"), 0u);
  EXPECT_EQ(count("for (int i = 0; i < grids.shape.y; ++i) {}"), 0u);
  EXPECT_EQ(count("for (int i = 0; i < 4 || x; ++i) {}"), 1u);
  EXPECT_EQ(count("for (int i = 4; i > 0 && x; --i) {}"), 0u);
  EXPECT_EQ(count("do bits &= bits - 1u;\nwhile (bits != 0u);  // ends: each turn clears a bit"), 0u);
}

// Derivatives, and the mip levels that texture() takes from them, are undefined where some lanes have left
// [GLSL 4.30, 8.9, 8.13.1]. `// uniform: reason` allows an exit that all lanes take.
TEST(ShaderForm, DerivativesComeBeforeLanesLeave) {
  std::vector<Shader> all = shaders();
  const std::set<std::string> derive = thatDerive(all);
  EXPECT_TRUE(derive.contains("materialAlbedo"));
  EXPECT_TRUE(derive.contains("pointLight"));
  for (const Shader& shader : all)
    if (!shader.file.ends_with(".comp"))
      for (const std::size_t line : lateDerivatives(shader, derive)) ADD_FAILURE() << shader.file << ":" << line;
  const auto count = [&](const char* text) { return lateDerivatives(shaderOf(text), derive).size(); };
  EXPECT_EQ(count("float f(float c) { if (c <= 0.0) return 0.0; return texture(map, p).r; }"), 1u);
  EXPECT_EQ(count("void main() { if (cut) { discard; } vec3 albedo = materialAlbedo(p); }"), 1u);
  EXPECT_EQ(count("float f() { float t = texture(map, p).r; if (t < 0.5) discard; return t; }"), 0u);
}

/// Lines that match, without their comments.
std::vector<std::string> linesWith(const std::vector<Shader>& all, const std::regex& pattern) {
  std::vector<std::string> result;
  for (const Shader& shader : all)
    for (std::size_t i = 0; i < shader.lines.size(); ++i)
      if (const std::string code = shader.lines[i].substr(0, shader.lines[i].find("//"));
          std::regex_search(code, pattern))
        result.push_back(shader.file + ":" + std::to_string(i + 1));
  return result;
}

// How many groups run may come from a buffer (an indirect dispatch): a number of theirs is compared first.
TEST(ShaderForm, GroupsDoNotIndexBuffersUnchecked) {
  EXPECT_EQ(linesWith(shaders(), std::regex(R"(\w\[[^\]]*gl_WorkGroupID)")), std::vector<std::string>());
  EXPECT_EQ(
      linesWith({shaderOf("uint index = lit[first + gl_WorkGroupID.x];")}, std::regex(R"(\w\[[^\]]*gl_WorkGroupID)"))
          .size(),
      1u);
}

// Drivers shade pixels beside the scissor, too: only forward/inspected.glsl writes, after it has compared.
TEST(ShaderForm, OnlyTheAskedPixelIsRecorded) {
  const std::vector<std::string> writes = linesWith(shaders(), std::regex(R"(\basked\[[^;]*=)"));
  ASSERT_EQ(writes.size(), 1u);
  EXPECT_TRUE(writes.front().starts_with("shaders/forward/inspected.glsl")) << writes.front();
}

// Counters of a frame take one atomic per group of pixels: at 1920x1080 half a million waited for one address.
TEST(ShaderForm, PixelsAreCountedByTheirGroup) {
  std::size_t counted = 0;
  for (const Shader& shader : shaders()) {
    if (!shader.file.starts_with("shaders/rsm/")) continue;
    for (std::size_t i = 0; i < shader.lines.size(); ++i) {
      if (shader.lines[i].find("(work.") == std::string::npos || shader.lines[i].find("atomic") == std::string::npos)
        continue;
      ++counted;
      std::size_t begin = i;
      while (begin > 0 && shader.lines[begin].find("if (") == std::string::npos) --begin;
      EXPECT_NE(shader.lines[begin].find("gl_LocalInvocationIndex == 0u"), std::string::npos)
          << shader.file << ":" << i + 1;
    }
  }
  EXPECT_GE(counted, 5u);
}

}  // namespace
