// Completions and the manual page, both made from the command line's own tree: asked as the shells ask, rendered as man
// renders.
#include "base/files.hpp"
#include "support/subprocess.hpp"
#include "support/temp_folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace {

namespace fs = std::filesystem;
using lucerna::test::run;
using lucerna::test::RunResult;
using lucerna::test::TempFolder;

using Words = std::vector<std::string>;

bool installed(const std::string& program) { return run("command -v " + program).exitCode == 0; }

Words linesOf(const std::string& text) {
  Words lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string inQuotes(const std::string& word) { return fmt::format("'{}'", word); }

/// What bash offers for the last of the words, into which it has divided the line ('=' is a word of its own).
Words bashCompletions(const Words& words, const std::string& folder = ".") {
  const TempFolder script;
  script.write("lucerna.bash", RUN_LUCERNA("completion bash").out);
  std::string line;
  for (const std::string& word : words) line += fmt::format(" '{}'", word);
  const RunResult result =
      run(std::string("cd ") + inQuotes(folder) +
          " && bash --norc --noprofile -c 'source \"$0\"; COMP_WORDS=(lucerna \"$@\"); COMP_CWORD=$#; _lucerna; " +
          std::string("((${#COMPREPLY[@]} == 0)) || printf \"%s\\n\" \"${COMPREPLY[@]}\"' ") +
          inQuotes((script / "lucerna.bash").string()) + line);
  EXPECT_EQ(result.exitCode, 0) << line;
  EXPECT_EQ(result.err, "") << line;
  return linesOf(result.out);
}

TEST(Completions, BashCompletesCommandsAndTheirOptions) {
  EXPECT_EQ(bashCompletions({"ben"}), Words{"bench"});
  EXPECT_EQ(bashCompletions({"bench", "s"}), Words{"stability"});
  EXPECT_EQ(bashCompletions({"bench", "error", "--refer"}), (Words{"--references", "--reference-spp"}));
  EXPECT_EQ(bashCompletions({"radiosity", "solve", "--vis"}), Words{"--visibility"});
  EXPECT_EQ(bashCompletions({"render", "--vis"}), Words{}) << "an option of another command";
}

TEST(Completions, BashCompletesValues) {
  EXPECT_EQ(bashCompletions({"render", "--technique", "r"}), (Words{"rsm", "radiosity"}));
  EXPECT_EQ(bashCompletions({"render", "a.obj", "--technique", "p"}), Words{"path"});
  EXPECT_EQ(bashCompletions({"walk", "--technique", "p"}), Words{"path"});
  EXPECT_EQ(bashCompletions({"render", "--set", "lpv.lookup", "=", "f"}), Words{"flux"});
  EXPECT_EQ(bashCompletions({"render", "--set", "rsm.interpolate", "="}), (Words{"on", "off"}));
  EXPECT_EQ(bashCompletions({"render", "--technique", "=", "lp"}), Words{"lpv"});
  EXPECT_EQ(bashCompletions({"render", "--set", "lpv.casc"}), Words{"lpv.cascades="});
  EXPECT_EQ(bashCompletions({"render", "--set", "=", "lpv.casc"}), Words{"lpv.cascades="});
  EXPECT_EQ(bashCompletions({"radiosity", "solve", "--set", "radiosity.m"}), Words{"radiosity.memory="})
      << "radiosity.mesh and radiosity.mapping belong to the view";
  EXPECT_EQ(bashCompletions({"radiosity", "generate", "out.bin", ""}), (Words{"1", "2", "3"}));
  EXPECT_EQ(bashCompletions({"render", "--repeat", ""}), Words{}) << "a number";
  // Bash puts the answer in the place of what follows '='.
  EXPECT_EQ(bashCompletions({"render", "--deviation", "lpv.flux-units", "="}), (Words{"on", "off"}));
  EXPECT_EQ(bashCompletions({"render", "--deviation", "lpv.flux-units", "=", "of"}), Words{"off"});
}

TEST(Completions, BashCompletesFilesWithSpacesToo) {
  const TempFolder folder;
  folder.write("my scene.obj", "");
  folder.write("other.obj", "");
  EXPECT_EQ(bashCompletions({"render", "my"}, folder.path().string()), Words{"my scene.obj"});
  EXPECT_EQ(bashCompletions({"render", "my scene.obj", "-o", "oth"}, folder.path().string()), Words{"other.obj"});
  EXPECT_EQ(bashCompletions({"render", "x", "y"}, folder.path().string()), Words{}) << "render takes one scene";
}

// What is offered is what the program takes: its message for a wrong value lists the right ones.
TEST(Completions, OfferWhatTheProgramTakes) {
  const TempFolder folder;
  folder.write("scene.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  struct Case {
    const char* before;  ///< the command and what must be given
    const char* option;
  };
  for (const Case& c :
       {Case{"render x.obj -o x.png", "--component"}, Case{"render x.obj -o x.png", "--fidelity"},
        Case{"walk", "--technique"}, Case{"bench tables", "--original"}, Case{"bench pictures -o x.png", "--original"},
        Case{"bench pictures -o x.png --original lpv", "--fidelity"}, Case{"bench all --out x", "--parts"},
        Case{"bench error", "--techniques"}, Case{"radiosity solve scene.obj x", "--solver"},
        Case{"radiosity solve x x", "--fidelity"}, Case{"radiosity show x", "--mapping"}, Case{"info", "--host"}}) {
    const RunResult refused =
        run(fmt::format("cd '{}' && '{}' {} {} nonsense", folder.path().string(), LUCERNA_BINARY, c.before, c.option));
    EXPECT_EQ(refused.exitCode, 2) << c.before << " " << c.option;
    const auto start = refused.err.find("expected one of ");
    ASSERT_NE(start, std::string::npos) << refused.err;
    std::string list = refused.err.substr(start + 16);
    std::replace(list.begin(), list.end(), ',', ' ');
    std::istringstream stream(list);
    Words taken;
    for (std::string word; stream >> word;)
      if (word != "and") taken.push_back(word);
    Words words;
    std::istringstream before(c.before);
    for (std::string word; before >> word;) words.push_back(word);
    words.insert(words.end(), {c.option, ""});
    Words offered = bashCompletions(words);
    std::sort(taken.begin(), taken.end());
    std::sort(offered.begin(), offered.end());
    EXPECT_EQ(offered, taken) << c.before << " " << c.option;
  }
}

TEST(Completions, EveryDeviationThatIsOfferedIsTaken) {
  const Words deviations = bashCompletions({"render", "--deviation", ""});
  EXPECT_GT(deviations.size(), 20u);
  std::string all = "render nowhere.obj -o x.png";
  for (const std::string& deviation : deviations) all.append(" --deviation ").append(deviation);
  const RunResult result = RUN_LUCERNA(all);
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("nowhere.obj: no such file"), std::string::npos)
      << "options are read before the scene; " << result.err;
}

TEST(Completions, FishCompletesCommandsOptionsAndValues) {
  if (!installed("fish")) GTEST_SKIP() << "fish is not installed";
  const TempFolder folder;
  folder.write("lucerna.fish", RUN_LUCERNA("completion fish").out);
  const auto offers = [&](const std::string& line) {
    const RunResult result =
        run(std::string("cd ") + inQuotes(folder.path().string()) +
            " && HOME=\"$PWD\" fish --no-config -c 'source lucerna.fish; complete -C \"" + line + "\"'");
    EXPECT_EQ(result.err, "");
    Words words;
    for (const std::string& text : linesOf(result.out)) words.push_back(text.substr(0, text.find('\t')));
    return words;
  };
  EXPECT_EQ(offers("lucerna ben"), Words{"bench"});
  EXPECT_EQ(offers("lucerna bench st"), Words{"stability"});
  EXPECT_EQ(offers("lucerna render --techniq"), Words{"--technique"});
  EXPECT_EQ(offers("lucerna render --technique p"), Words{"path"});
  EXPECT_EQ(offers("lucerna walk --technique pat"), Words{"path"});
  EXPECT_EQ(offers("lucerna walk --technique patch"), Words{});
  EXPECT_EQ(offers("lucerna render --set lpv.casc"), Words{"lpv.cascades="});
  EXPECT_EQ(offers("lucerna render lucerna.f"), Words{"lucerna.fish"});
}

// In a terminal of its own, with the keys that a user would press.
TEST(Completions, ZshCompletesCommandsOptionsAndValues) {
  if (!installed("zsh")) GTEST_SKIP() << "zsh is not installed";
  const TempFolder folder;
  folder.write("_lucerna", RUN_LUCERNA("completion zsh").out);
  folder.write(
      "ask.zsh",
      "zmodload zsh/zpty\n"
      "zpty shell TERM=dumb HOME=$PWD zsh -f -i\n"
      "zpty -w shell 'PS1=; autoload -Uz compinit; fpath=($PWD $fpath); compinit -u -D; stty -echo; print ready'\n"
      "zpty -r -m shell text '*ready*ready*' || exit 1\n"
      // Ctrl-X e shows the line as it is.
      "zpty -w shell $'show() { print \"<$BUFFER>\"; BUFFER=; }; zle -N show; bindkey \"^Xe\" show; print set'\n"
      "zpty -r -m shell text '*set*set*' || zpty -r -m shell text '*set*'\n"
      "zpty -w -n shell \"$1\"$'\\t\\030e'\n"
      "zpty -r -m shell text '*<*>*'\n"
      "text=${text##*<}; print -r -- ${text%%>*}\n");
  const auto completed = [&](const std::string& line) {
    const RunResult result =
        run(std::string("cd ") + inQuotes(folder.path().string()) + " && timeout 60 zsh -f ask.zsh " + inQuotes(line));
    return linesOf(result.out).empty() ? result.err : linesOf(result.out).front();
  };
  EXPECT_EQ(completed("lucerna ben"), "lucerna bench ");
  EXPECT_EQ(completed("lucerna bench st"), "lucerna bench stability ");
  EXPECT_EQ(completed("lucerna render --techn"), "lucerna render --technique=");
  EXPECT_EQ(completed("lucerna render --technique=p"), "lucerna render --technique=path ");
  EXPECT_EQ(completed("lucerna render --set lpv.casc"), "lucerna render --set lpv.cascades=");
}

TEST(Completions, AnUnknownShellIsRefused) {
  const RunResult result = RUN_LUCERNA("completion tcsh");
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.err, "lucerna: SHELL tcsh: unknown; expected one of bash, zsh, fish\n");
  EXPECT_EQ(result.out, "");
}

TEST(ManualPage, IsFormattedWithoutWarnings) {
  const TempFolder folder;
  folder.write("lucerna.1", RUN_LUCERNA("manual").out);
  const std::string file = inQuotes((folder / "lucerna.1").string());
  bool tried = false;
  if (installed("man") && installed("groff")) {
    tried = true;
    const RunResult man =
        run("LC_ALL=C.UTF-8 MANROFFSEQ= MANWIDTH=80 man --warnings -E UTF-8 -l -Tutf8 -Z " + file + " >/dev/null");
    EXPECT_EQ(man.exitCode, 0);
    EXPECT_EQ(man.err, "");
  }
  if (installed("mandoc")) {
    tried = true;
    const RunResult lint = run("mandoc -Tlint -W warning " + file);
    EXPECT_EQ(lint.exitCode, 0);
    EXPECT_EQ(lint.out, "");
  }
  if (!tried) GTEST_SKIP() << "neither man nor mandoc is installed";
}

TEST(SettingsPage, IsWhatTheProgramPrints) {
  EXPECT_EQ(lucerna::readFileText(LUCERNA_SOURCE_DIR "/docs/settings.md"), RUN_LUCERNA("info --settings").out)
      << "lucerna info --settings > docs/settings.md";
}

TEST(ManualPage, TellsEveryCommandAndItsOptions) {
  const std::string page = RUN_LUCERNA("manual").out;
  for (const char* part : {".SS \"lucerna walk\"", ".SS \"lucerna bench error\"", "\\fB\\-\\-reference\\-spp\\fR",
                           "\\fBlpv.cascades\\fR", "LUCERNA_DATA", ".SH EXIT STATUS"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  // Every option that --help lists for a command stands in the command's own part.
  const auto begin = page.find(".SS \"lucerna radiosity solve\"");
  const std::string part = page.substr(begin, page.find(".SS", begin + 1) - begin);
  std::size_t options = 0;
  for (const std::string& line : linesOf(RUN_LUCERNA("radiosity solve --help").out)) {
    const auto start = line.find_first_not_of(' ');  // how far in, versions of CLI11 differ
    if (start == 0 || start == std::string::npos || line.compare(start, 2, "--") != 0) continue;
    std::string name = line.substr(start, line.find(' ', start) - start);
    if (name == "--host" || name == "--json" || name == "--quiet") continue;
    for (std::size_t at = 0; (at = name.find('-', at)) != std::string::npos; at += 2) name.replace(at, 1, "\\-");
    EXPECT_NE(part.find("\\fB" + name + "\\fR"), std::string::npos) << name;
    ++options;
  }
  EXPECT_GT(options, 10u);
}

/// A system without apt-get: nothing on its PATH but a few tools, and a package manager that lacks some packages.
class SystemWithoutApt : public ::testing::Test {
 protected:
  SystemWithoutApt() {
    for (const char* tool : {"awk", "dirname", "nproc"})
      fs::create_symlink(linesOf(run(std::string("command -v ") + tool).out).at(0), folder_ / tool);
  }
  void addManager(const std::string& manager, const std::string& query, const std::string& missing) {
    for (const std::string& name : {manager, query}) {
      folder_.write(name, "#!/bin/sh\ncase ' " + missing + " ' in *\" $2 \"*) exit 1 ;; esac\n");
      fs::permissions(folder_ / name, fs::perms::owner_all);
    }
  }
  RunResult shell(const std::string& command) const {
    return run("cd '" LUCERNA_SOURCE_DIR "' && PATH=" + inQuotes(folder_.path().string()) + " /bin/sh " + command);
  }
  TempFolder folder_;
};

TEST_F(SystemWithoutApt, FedoraIsToldWhatToInstall) {
  addManager("dnf", "rpm", "glew-devel gnuplot gtest-devel");
  const RunResult demo = shell("demo/run");
  EXPECT_EQ(demo.exitCode, 3);
  EXPECT_EQ(demo.err,
            "lucerna: needed too, under a name that is not known here: libimgui-dev (docs/packages.md)\n"
            "lucerna: packages are missing: sudo dnf install glew-devel\nlucerna: optional ones: gnuplot\n");
  const RunResult tests = shell("tests/run");
  EXPECT_EQ(tests.exitCode, 3);
  EXPECT_NE(tests.err.find("sudo dnf install glew-devel gtest-devel\n"), std::string::npos) << tests.err;
}

TEST_F(SystemWithoutApt, ArchIsToldWhatToInstallAndBuildsWithoutOptionalPackages) {
  const std::string install =
      "-c '. demo/setup.sh; install_packages $run_packages -- $optional_run_packages && echo on'";
  addManager("pacman", "pacman", "mesa devil");
  const RunResult lacks = shell(install);
  EXPECT_EQ(lacks.exitCode, 3);
  EXPECT_EQ(lacks.err, "lucerna: packages are missing: sudo pacman -S devil mesa\n");
  addManager("pacman", "pacman", "gnuplot");
  const RunResult complete = shell(install);
  EXPECT_EQ(complete.out, "on\n");
  EXPECT_EQ(complete.err, "lucerna: continuing without gnuplot\n");
}

TEST_F(SystemWithoutApt, OthersArePointedToTheList) {
  const RunResult result = shell("-c '. demo/setup.sh; install_packages $run_packages && echo on'");
  EXPECT_EQ(result.out, "on\n");
  EXPECT_EQ(result.err, "lucerna: no apt-get, dnf or pacman here; docs/packages.md lists what is needed\n");
}

}  // namespace
