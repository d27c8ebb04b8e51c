# The dense atlas of the nominal adult, into the folder that is mounted:
#   docker build -t standfast .
#   docker run --rm -v "$PWD/results:/standfast/results" standfast
# Any other command: docker run --rm standfast .venv/bin/standfast --help
FROM python:3.13-slim
RUN apt-get update && apt-get install -y --no-install-recommends make && rm -rf /var/lib/apt/lists/*
WORKDIR /standfast
COPY pyproject.toml hatch_build.py constraints.txt Makefile README.md LICENSE CITATION.cff ./
COPY src src
COPY studies studies
RUN make .venv/run.stamp
CMD ["make", "atlas"]
