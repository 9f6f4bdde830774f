# robomill for several people. Build and run, with limits that fit a small machine:
#
#   docker build -t robomill .
#   docker run --rm --init -p 127.0.0.1:8501:8501 -v robomill-work:/home/robomill/.local/state/robomill \
#       --memory 3g --cpus 2 --pids-limit 512 --read-only --tmpfs /tmp \
#       --cap-drop ALL --security-opt no-new-privileges robomill
#
# Words after the image's name go to `robomill serve`: ... robomill --host-name robomill.example.org --autosave off
FROM python:3.11-slim

RUN apt-get update \
    && apt-get install -y --no-install-recommends libegl1 libgl1-mesa-dri \
    && rm -rf /var/lib/apt/lists/* \
    && useradd --create-home --uid 10001 robomill

WORKDIR /opt/robomill
COPY pyproject.toml constraints.txt README.md LICENSE app.py ./
COPY .streamlit .streamlit
COPY pages pages
COPY samples samples
COPY robomill robomill
# Compiled here, as the files belong to root and the server may write only where people's work is kept; for any processor,
# as another than the builder's would else compile everything anew in every process. An image that stays where it was
# built computes faster without this line.
ENV NUMBA_CPU_NAME=generic
RUN pip install --no-cache-dir -c constraints.txt -e ".[all]" \
    && python -m robomill.compiled \
    && install -d -o robomill -m 700 /home/robomill/.local /home/robomill/.local/state /home/robomill/.local/state/robomill

USER robomill
ENV PYTHONDONTWRITEBYTECODE=1 MPLCONFIGDIR=/tmp
VOLUME /home/robomill/.local/state/robomill
EXPOSE 8501
HEALTHCHECK --interval=30s --timeout=5s --start-period=60s \
    CMD ["python", "-c", "import urllib.request as r; r.urlopen('http://127.0.0.1:8501/_stcore/health', timeout=4)"]
ENTRYPOINT ["robomill", "serve", "--address", "0.0.0.0"]
