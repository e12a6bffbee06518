#include "apps/mixbeam/view_page.hpp"

#include "discretization/results/disk_file.hpp"
#include "discretization/text/errors.hpp"
#include "discretization/text/tags.hpp"
#include "discretization/text/text_file.hpp"

#include <cmath>
#include <fstream>

namespace mixbeam {

namespace {

namespace fs = std::filesystem;

const std::string kBegin = "<!doctype html>";
/// Policy that forbids all requests, whatever the page contains.
constexpr const char* kPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; img-src data: blob:; script-src 'unsafe-inline'";
constexpr const char* kScripts[] = {"numbers", "packed", "result",  "camera", "shapes", "shaders", "painter",
                                    "marks",   "curve",  "picking", "panel",  "main",   "input"};

/// Deflated bytes as a script element in base64, which the browser does not interpret.
std::string element(const std::string& name, const std::string& bytes) {
  return "<script type=\"application/octet-stream\" id=\"" + xml_escaped(name) + "\">" + base64(bytes) + "</script>\n";
}

}  // namespace

std::string view_page(const std::vector<fs::path>& files, const std::optional<SaidOfScene>& said, const fs::path& parts,
                      int renew, const PageLimits& limits) {
  PageLimits of_each = limits;
  of_each.bytes /= std::sqrt(static_cast<double>(files.size()));
  std::vector<ViewData> cases;
  for (const fs::path& file : files) {
    try {
      cases.push_back(view_data(SampledFile(file), said, of_each));
    } catch (const InputError& error) {
      const std::string text = error.what();
      throw InputError(text.find(file.string()) == std::string::npos ? file.string() + ": " + text : text);
    }
  }
  nlohmann::json pages = {{"cases", nlohmann::json::array()}, {"renew", renew}};
  for (const ViewData& data : cases) pages["cases"].push_back(data.load_case);
  const auto own = [&](const std::string& name) { return text_of_file((parts / name).string(), "part of the page"); };
  std::string page =
      kBegin +
      "<html lang=\"en\"><head><meta charset=\"utf-8\"><meta http-equiv=\"Content-Security-Policy\" content=\"" +
      kPolicy + "\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>" +
      xml_escaped(cases.size() == 1 ? cases[0].title : cases[0].scene_name) + "</title><style>" + own("viewer.css") +
      "</style></head><body>\n" + own("page.html") + "\n";
  constexpr auto kReplace = nlohmann::json::error_handler_t::replace;  // names may be invalid UTF-8
  page += element("pages", deflated(pages.dump(-1, ' ', false, kReplace)));
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (const auto& [name, bytes] : cases[i].arrays) page += element(std::to_string(i) + "/" + name, bytes);
  page += "<script>\n(() => {\n\"use strict\";\n";
  for (const char* script : kScripts) page += own(std::string(script) + ".js") + "\n";
  return page + "})();\n</script>\n</body></html>\n";
}

void write_page(const fs::path& path, const std::string& text) {
  std::error_code ignored;
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored))
    throw InputError(path.string() + ": is there and is no file; allowed: the name of a file");
  std::string begin(kBegin.size(), '\0');
  std::ifstream there(path, std::ios::binary);
  there.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (there.gcount() > 0 && begin != kBegin)
    throw InputError(path.string() + ": is there and is no page, and is not written over; allowed: another name");
  replace_file(path, text, false);
}

}  // namespace mixbeam
