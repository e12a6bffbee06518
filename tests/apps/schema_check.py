"""Judges scenes in YAML by a JSON Schema: schema_check.py SCHEMA FILE... prints a line for each, empty where it is valid."""
import json
import sys

import jsonschema
import yaml


class Loader(yaml.SafeLoader):
    """PyYAML follows YAML 1.1, in which on and no are switches; editors and mixbeam follow 1.2."""


Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if first not in "yYnNoO" or tag != "tag:yaml.org,2002:bool"]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()}


def judged(validator, file):
    try:
        with open(file, encoding="utf-8") as stream:
            scene = yaml.load(stream, Loader)
    except yaml.YAMLError as error:
        return "no YAML: " + str(error).replace("\n", " ")
    errors = [f"{'/'.join(map(str, error.absolute_path))}: {error.message}" for error in validator.iter_errors(scene)]
    return errors[0].replace("\n", " ")[:300] if errors else ""


def main():
    with open(sys.argv[1], encoding="utf-8") as stream:
        schema = json.load(stream)
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    for file in sys.argv[2:]:
        print(judged(validator, file))


if __name__ == "__main__":
    main()
